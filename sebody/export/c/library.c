/* The functions of a library, see its header. */
#include "derivatives.h"
#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

EXPORT Instance *NAMED(new)(void) { return instance_new(); }
EXPORT void NAMED(free)(Instance *m) { instance_free(m); }
EXPORT void NAMED(reset)(Instance *m) { instance_reset(m); }
EXPORT int NAMED(run)(Instance *m, int64_t steps, double *rows) {
  return instance_run(m, steps, rows);
}
EXPORT int NAMED(run_to)(Instance *m, double t) { return instance_run_to(m, t); }
EXPORT double NAMED(time)(const Instance *m) { return time_of(m); }
EXPORT int NAMED(set)(Instance *m, int input, double value) {
  if (input < 0 || input >= INPUTS) {
    snprintf(m->message, sizeof m->message, "%s: there is no input %d: give one of %d",
             MODEL_NAME, input, INPUTS);
    return 1;
  }
  if (instance_refuses(m, input, value)) return 1;
  instance_set(m, input, value);
  return 0;
}
EXPORT double NAMED(get)(Instance *m, int output) {
  return output < 0 || output >= VARIABLES ? NAN : instance_output(m, output);
}
EXPORT int NAMED(derivative)(Instance *m, int output, int input, double *value) {
  double one = 1.0;
  if (!DERIVATIVES || output < 0 || output >= VARIABLES || input < 0 || input >= INPUTS) {
    snprintf(m->message, sizeof m->message, DERIVATIVES
             ? "%s: output %d by input %d: there are %d outputs and %d inputs"
             : "%s: there are no derivatives, because some motions have no mass",
             MODEL_NAME, output, input, VARIABLES, INPUTS);
    return 1;
  }
  return instance_derivatives(m, &output, 1, &input, &one, 1, value);
}
EXPORT const double *NAMED(row)(const Instance *m) { return numbers(m, AT_NOW); }
EXPORT const char *NAMED(error)(const Instance *m) { return m->message; }
EXPORT size_t NAMED(state_size)(void) { return STATE_BYTES; }
EXPORT void NAMED(save)(const Instance *m, void *to) { instance_save(m, to); }
EXPORT int NAMED(restore)(Instance *m, const void *from) { return instance_restore(m, from); }
