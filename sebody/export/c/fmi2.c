/* FMI 2.0 for co-simulation, https://fmi-standard.org/downloads. */
#include "fmi.h"

enum { CO_SIMULATION = 1 };     /* fmi2Type */

typedef void (*Log)(void *environment, const char *name, int status, const char *category,
                    const char *message, ...);
typedef struct {
  Log log;
  void *(*allocate)(size_t, size_t);
  void (*release)(void *);
  void (*finished)(void *, int);
  void *environment;
} Callbacks;

static void tell(const Fmu *fmu, int status, const char *message) {
  if (fmu->log)
    ((Log)fmu->log)(fmu->environment, fmu->name, status, "logStatusError", "%s", message);
}

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT int fmi2SetDebugLogging(Fmu *fmu, int on, size_t count, const char *const categories[]) {
  (void)fmu, (void)on, (void)count, (void)categories;      /* errors alone are told, always */
  return OK;
}
EXPORT Fmu *fmi2Instantiate(const char *name, int type, const char *token, const char *resources,
                            const Callbacks *callbacks, int visible, int logging) {
  (void)resources, (void)visible, (void)logging;
  if (type != CO_SIMULATION) return 0;
  return fmu_new(name, token, callbacks ? callbacks->environment : 0,
                 callbacks ? (void (*)(void))callbacks->log : 0);
}
EXPORT void fmi2FreeInstance(Fmu *fmu) { fmu_free(fmu); }
EXPORT int fmi2SetupExperiment(Fmu *fmu, int defined, double tolerance, double start, int ends,
                               double stop) {
  (void)defined, (void)tolerance, (void)ends, (void)stop;
  return start == 0.0 ? OK : refuse(fmu, "the model starts at t = 0: give this start time");
}
EXPORT int fmi2EnterInitializationMode(Fmu *fmu) { return fmu_begin(fmu, 0.0); }
EXPORT int fmi2ExitInitializationMode(Fmu *fmu) { return fmu_initialized(fmu); }
EXPORT int fmi2Terminate(Fmu *fmu) { return fmu_end(fmu); }
EXPORT int fmi2Reset(Fmu *fmu) { return fmu_reset(fmu); }

EXPORT int fmi2GetReal(Fmu *fmu, const uint32_t references[], size_t count, double values[]) {
  return fmu_get(fmu, references, count, values);
}
EXPORT int fmi2SetReal(Fmu *fmu, const uint32_t references[], size_t count,
                       const double values[]) {
  return fmu_set(fmu, references, count, values);
}
EXPORT int fmi2DoStep(Fmu *fmu, double t, double length, int no_return) {
  (void)no_return;
  return fmu_step(fmu, t, length);
}

EXPORT int fmi2GetFMUstate(Fmu *fmu, void **state) { return fmu_save(fmu, state); }
EXPORT int fmi2SetFMUstate(Fmu *fmu, void *state) { return fmu_restore(fmu, state); }
EXPORT int fmi2FreeFMUstate(Fmu *fmu, void **state) { (void)fmu; return fmu_free_state(state); }
EXPORT int fmi2SerializedFMUstateSize(Fmu *fmu, void *state, size_t *size) {
  (void)fmu, (void)state;
  *size = FMU_STATE_BYTES;
  return OK;
}
EXPORT int fmi2SerializeFMUstate(Fmu *fmu, void *state, uint8_t bytes[], size_t size) {
  return fmu_to_bytes(fmu, state, bytes, size);
}
EXPORT int fmi2DeSerializeFMUstate(Fmu *fmu, const uint8_t bytes[], size_t size, void **state) {
  return fmu_from_bytes(fmu, bytes, size, state);
}

EXPORT int fmi2GetDirectionalDerivative(
    Fmu *fmu, const uint32_t unknowns[], size_t wanted, const uint32_t knowns[], size_t count,
    const double seed[], double sensitivity[]) {
  return fmu_derivatives(fmu, unknowns, wanted, knowns, count, seed, sensitivity);
}

/* What importers look for, and what a model of inputs and outputs that are numbers has not. */
#define NONE(name) \
  EXPORT int name(Fmu *fmu) { return refuse(fmu, #name " is not supported"); }
#define NO_VALUES(type) NONE(fmi2Get##type) NONE(fmi2Set##type)

NO_VALUES(Integer) NO_VALUES(Boolean) NO_VALUES(String)
NONE(fmi2SetRealInputDerivatives)
NONE(fmi2GetRealOutputDerivatives) NONE(fmi2CancelStep) NONE(fmi2GetStatus)
NONE(fmi2GetRealStatus) NONE(fmi2GetIntegerStatus) NONE(fmi2GetBooleanStatus)
NONE(fmi2GetStringStatus)
