/* What FMI 2.0 and 3.0 have in common: an instance of the model, its variables and its messages.

   Value references: 0 is the time, then come inputs, then outputs. */
#include "derivatives.h"
#include "token.h"
#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { OK, WARNING, DISCARD, ERROR, FATAL };    /* fmi2Status and fmi3Status; 2.0 has one more */
enum { MADE, INITIALIZED, STEPS, ENDED };       /* phases */

typedef struct {
  Instance *model;
  int phase;
  char *name;
  void *environment;
  void (*log)(void);        /* the importer's function, of the type of the version */
} Fmu;

static void tell(const Fmu *fmu, int status, const char *message);     /* by the version */

static int refuse(const Fmu *fmu, const char *message) {
  tell(fmu, ERROR, message);
  return ERROR;
}

static Fmu *fmu_new(const char *name, const char *token, void *environment, void (*log)(void)) {
  Fmu own = {0, MADE, 0, environment, log};
  if (!token || strcmp(token, TOKEN)) {
    own.name = (char *)(name ? name : MODEL_NAME);
    refuse(&own, "the token is not that of the model description: unzip the FMU again");
    return 0;
  }
  Fmu *fmu = calloc(1, sizeof *fmu);
  if (!fmu) return 0;
  *fmu = own;
  size_t length = strlen(name ? name : MODEL_NAME) + 1;
  fmu->name = malloc(length);
  fmu->model = instance_new();
  if (!fmu->name || !fmu->model) {
    free(fmu->name);
    instance_free(fmu->model);
    free(fmu);
    return 0;
  }
  memcpy(fmu->name, name ? name : MODEL_NAME, length);
  return fmu;
}

static void fmu_free(Fmu *fmu) {
  if (!fmu) return;
  instance_free(fmu->model);
  free(fmu->name);
  free(fmu);
}

static int fmu_begin(Fmu *fmu, double start) {
  if (fmu->phase != MADE) return refuse(fmu, "initialization begins only after instantiation");
  if (start != 0.0) return refuse(fmu, "the model starts at t = 0: give this start time");
  fmu->phase = INITIALIZED;
  return OK;
}

/* Solve for the accelerations that follow from what was set. */
static int fmu_initialized(Fmu *fmu) {
  if (fmu->phase != INITIALIZED) return refuse(fmu, "initialization has not begun");
  if (instance_run_to(fmu->model, time_of(fmu->model))) return refuse(fmu, fmu->model->message);
  fmu->phase = STEPS;
  return OK;
}

static int fmu_reset(Fmu *fmu) {
  instance_reset(fmu->model);
  fmu->phase = MADE;
  return OK;
}

static int fmu_end(Fmu *fmu) {
  fmu->phase = ENDED;
  return OK;
}

static int fmu_set(Fmu *fmu, const uint32_t *references, size_t count, const double *values) {
  for (size_t k = 0; k < count; k++) {
    if (references[k] < 1 || references[k] > INPUTS)
      return refuse(fmu, "a variable that is no input or parameter cannot be set");
    int input = (int)references[k] - 1;
    if (instance_refuses(fmu->model, input, values[k])) return refuse(fmu, fmu->model->message);
    instance_set(fmu->model, input, values[k]);
  }
  return OK;
}

static int fmu_get(Fmu *fmu, const uint32_t *references, size_t count, double *values) {
  for (size_t k = 0; k < count; k++) {
    uint32_t at = references[k];
    if (at > INPUTS + VARIABLES) return refuse(fmu, "there is no variable of this value reference");
    values[k] = at == 0 ? time_of(fmu->model)
                : at <= INPUTS ? instance_input(fmu->model, (int)at - 1)
                : instance_output(fmu->model, (int)at - INPUTS - 1);
  }
  return OK;
}

/* Derivatives of outputs along a direction, `seed`, of inputs and parameters. */
static int fmu_derivatives(Fmu *fmu, const uint32_t *unknowns, size_t wanted,
                           const uint32_t *knowns, size_t count, const double *seed, double *to) {
  if (!DERIVATIVES)
    return refuse(fmu, "there are no directional derivatives, because some motions have no mass");
  if (fmu->phase != INITIALIZED && fmu->phase != STEPS)
    return refuse(fmu, "directional derivatives are those of an initialized model");
  for (size_t k = 0; k < count; k++) {
    if (knowns[k] < 1 || knowns[k] > INPUTS)
      return refuse(fmu, "derivatives by a variable that is no input or parameter");
    if (!isfinite(seed[k])) return refuse(fmu, "a seed is not finite");
  }
  for (size_t k = 0; k < wanted; k++)
    if (unknowns[k] <= INPUTS || unknowns[k] > INPUTS + VARIABLES)
      return refuse(fmu, "derivatives of a variable that is no output");
  int *places = malloc((wanted + count + 1) * sizeof *places);
  if (!places) return refuse(fmu, "there is no memory");
  for (size_t k = 0; k < wanted; k++) places[k] = (int)unknowns[k] - INPUTS - 1;
  for (size_t k = 0; k < count; k++) places[wanted + k] = (int)knowns[k] - 1;
  int failed = instance_derivatives(fmu->model, places, (int)wanted, places + wanted, seed,
                                    (int)count, to);
  free(places);
  return failed ? refuse(fmu, fmu->model->message) : OK;
}

static int fmu_step(Fmu *fmu, double t, double length) {
  double h = clock_of(fmu->model)[CLOCK_STEP];
  if (fmu->phase != STEPS) return refuse(fmu, "steps are done only after initialization");
  if (fabs(t - time_of(fmu->model)) > ON_GRID * h + 1e-12 * fabs(t))
    return refuse(fmu, "the communication point is not the time that the model has reached");
  if (!(length >= 0.0)) return refuse(fmu, "a communication step is below zero");
  return instance_run_to(fmu->model, t + length) ? refuse(fmu, fmu->model->message) : OK;
}

/* States: the model's, behind the phase. */
#define FMU_STATE_BYTES (sizeof(int64_t) + STATE_BYTES)

static int fmu_save(Fmu *fmu, void **state) {
  if (!*state && !(*state = malloc(FMU_STATE_BYTES))) return refuse(fmu, "there is no memory");
  int64_t phase = fmu->phase;
  memcpy(*state, &phase, sizeof phase);
  instance_save(fmu->model, (char *)*state + sizeof phase);
  return OK;
}

static int fmu_restore(Fmu *fmu, const void *state) {
  int64_t phase;
  if (!state) return refuse(fmu, "there is no state to restore");
  memcpy(&phase, state, sizeof phase);
  if (instance_restore(fmu->model, (const char *)state + sizeof phase))
    return refuse(fmu, fmu->model->message);
  fmu->phase = (int)phase;
  return OK;
}

static int fmu_free_state(void **state) {
  if (state) { free(*state); *state = 0; }
  return OK;
}

static int fmu_to_bytes(Fmu *fmu, const void *state, void *bytes, size_t size) {
  if (!state || size < FMU_STATE_BYTES) return refuse(fmu, "too few bytes for a state");
  memcpy(bytes, state, FMU_STATE_BYTES);
  return OK;
}

static int fmu_from_bytes(Fmu *fmu, const void *bytes, size_t size, void **state) {
  if (size != FMU_STATE_BYTES) return refuse(fmu, "these bytes are not a state of this model");
  if (!*state && !(*state = malloc(size))) return refuse(fmu, "there is no memory");
  memcpy(*state, bytes, size);
  return OK;
}
