/* FMI 3.0 for co-simulation, https://fmi-standard.org/docs/3.0.2. */
#include <stdbool.h>
#include "fmi.h"

typedef void (*Log)(void *environment, int status, const char *category, const char *message);

static void tell(const Fmu *fmu, int status, const char *message) {
  if (fmu->log) ((Log)fmu->log)(fmu->environment, status, "logStatusError", message);
}

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
EXPORT int fmi3SetDebugLogging(Fmu *fmu, bool on, size_t count, const char *const categories[]) {
  (void)fmu, (void)on, (void)count, (void)categories;      /* errors alone are told, always */
  return OK;
}
EXPORT Fmu *fmi3InstantiateCoSimulation(
    const char *name, const char *token, const char *resources, bool visible, bool logging,
    bool events, bool early, const uint32_t required[], size_t count, void *environment, Log log,
    void *update) {
  (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)required;
  (void)count, (void)update;
  return fmu_new(name, token, environment, (void (*)(void))log);
}
EXPORT void fmi3FreeInstance(Fmu *fmu) { fmu_free(fmu); }
EXPORT int fmi3EnterInitializationMode(Fmu *fmu, bool defined, double tolerance, double start,
                                       bool ends, double stop) {
  (void)defined, (void)tolerance, (void)ends, (void)stop;
  return fmu_begin(fmu, start);
}
EXPORT int fmi3ExitInitializationMode(Fmu *fmu) { return fmu_initialized(fmu); }
EXPORT int fmi3Terminate(Fmu *fmu) { return fmu_end(fmu); }
EXPORT int fmi3Reset(Fmu *fmu) { return fmu_reset(fmu); }
EXPORT int fmi3EnterStepMode(Fmu *fmu) { return fmu->phase == STEPS ? OK : ERROR; }

EXPORT int fmi3GetFloat64(Fmu *fmu, const uint32_t references[], size_t count, double values[],
                          size_t size) {
  return size < count ? refuse(fmu, "too few values") : fmu_get(fmu, references, count, values);
}
EXPORT int fmi3SetFloat64(Fmu *fmu, const uint32_t references[], size_t count,
                          const double values[], size_t size) {
  return size < count ? refuse(fmu, "too few values") : fmu_set(fmu, references, count, values);
}
EXPORT int fmi3DoStep(Fmu *fmu, double t, double length, bool no_return, bool *event,
                      bool *terminate, bool *early, double *reached) {
  (void)no_return;
  *event = *terminate = *early = false;
  int status = fmu_step(fmu, t, length);
  *reached = time_of(fmu->model);
  return status;
}

EXPORT int fmi3GetFMUState(Fmu *fmu, void **state) { return fmu_save(fmu, state); }
EXPORT int fmi3SetFMUState(Fmu *fmu, void *state) { return fmu_restore(fmu, state); }
EXPORT int fmi3FreeFMUState(Fmu *fmu, void **state) { (void)fmu; return fmu_free_state(state); }
EXPORT int fmi3SerializedFMUStateSize(Fmu *fmu, void *state, size_t *size) {
  (void)fmu, (void)state;
  *size = FMU_STATE_BYTES;
  return OK;
}
EXPORT int fmi3SerializeFMUState(Fmu *fmu, void *state, uint8_t bytes[], size_t size) {
  return fmu_to_bytes(fmu, state, bytes, size);
}
EXPORT int fmi3DeserializeFMUState(Fmu *fmu, const uint8_t bytes[], size_t size, void **state) {
  return fmu_from_bytes(fmu, bytes, size, state);
}
EXPORT int fmi3GetOutputDerivatives(Fmu *fmu) { return refuse(fmu, "there are no derivatives"); }

EXPORT int fmi3GetDirectionalDerivative(
    Fmu *fmu, const uint32_t unknowns[], size_t wanted, const uint32_t knowns[], size_t count,
    const double seed[], size_t seeds, double sensitivity[], size_t size) {
  if (seeds < count || size < wanted) return refuse(fmu, "too few values");
  return fmu_derivatives(fmu, unknowns, wanted, knowns, count, seed, sensitivity);
}

/* What importers look for, and what a model of inputs and outputs that are numbers has not. */
#define NONE(name) \
  EXPORT int name(Fmu *fmu) { return refuse(fmu, #name " is not supported"); }
#define NO_VALUES(type) NONE(fmi3Get##type) NONE(fmi3Set##type)
#define NOTHING(name) EXPORT void *name(void) { return 0; }

NOTHING(fmi3InstantiateModelExchange)
NOTHING(fmi3InstantiateScheduledExecution)
NO_VALUES(Float32) NO_VALUES(Int8) NO_VALUES(UInt8) NO_VALUES(Int16) NO_VALUES(UInt16)
NO_VALUES(Int32) NO_VALUES(UInt32) NO_VALUES(Int64) NO_VALUES(UInt64) NO_VALUES(Boolean)
NO_VALUES(String) NO_VALUES(Binary) NO_VALUES(Clock)
NO_VALUES(IntervalDecimal) NO_VALUES(IntervalFraction) NO_VALUES(ShiftDecimal)
NO_VALUES(ShiftFraction)
NONE(fmi3EnterEventMode) NONE(fmi3EnterConfigurationMode) NONE(fmi3ExitConfigurationMode)
NONE(fmi3GetNumberOfVariableDependencies) NONE(fmi3GetVariableDependencies)
NONE(fmi3GetAdjointDerivative)
NONE(fmi3EvaluateDiscreteStates) NONE(fmi3UpdateDiscreteStates)
NONE(fmi3EnterContinuousTimeMode) NONE(fmi3CompletedIntegratorStep) NONE(fmi3SetTime)
NONE(fmi3GetContinuousStates) NONE(fmi3SetContinuousStates)
NONE(fmi3GetContinuousStateDerivatives) NONE(fmi3GetEventIndicators)
NONE(fmi3GetNominalsOfContinuousStates) NONE(fmi3GetNumberOfEventIndicators)
NONE(fmi3GetNumberOfContinuousStates) NONE(fmi3ActivateModelPartition)
