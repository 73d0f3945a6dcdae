/* Derivatives of outputs by inputs, at the time reached.

   Positions, velocities and states of controllers are what they are; accelerations, multipliers and
   the forces that follow from them change at once with an input, and are solved for anew. They are
   affine functions of loads and of accelerations of drives: central differences have rounding
   alone, however far inputs are moved. They are moved until accelerations and multipliers change
   by PROBE, so of any other function, of friction for one, differences have an error of its square.
   They are solved for with new factors: with kept ones they converge to 1e-10, which the division by
   PROBE makes an error of 1e-6.

   An instance is left as it was, bit for bit. */
#include "runtime.h"

#define PROBE 1e-4

typedef struct { Instance *m; char *saved; const int *inputs; const double *seed; int count; } Probe;

/* Accelerations and multipliers, in units of the iteration matrix. */
static void measure(const Instance *m, double *to) {
  const double *a = numbers(m, AT_A), *q = numbers(m, AT_Q), *w = numbers(m, AT_WEIGHT);
  const double *multiplier = numbers(m, AT_MULTIPLIERS);
  for (int i = 0; i < UNKNOWNS; i++) to[i] = (multiplier[i] > 0.0 ? q[i] : a[i]) * w[i];
}

static double norm(const double *x, const double *y) {
  double sum = 0.0;
  for (int i = 0; i < UNKNOWNS; i++) sum += (x[i] - y[i]) * (x[i] - y[i]);
  return sqrt(sum);
}

/* Move inputs along the seed from where they are, and solve for what follows; 0 if all went well. */
static int move_inputs(const Probe *p, double by) {
  instance_restore(p->m, p->saved);
  for (int i = 0; i < p->count; i++)
    instance_set(p->m, p->inputs[i], instance_input(p->m, p->inputs[i]) + by * p->seed[i]);
  control(p->m)[CONTROL_RESTART] = ASKED;
  if (KEEPS) *numbers(p->m, AT_FACTORS_VALID) = 0.0;
  return go(p->m, control(p->m)[CONTROL_GRID], 0, 0, 0);
}

/* How far to move inputs; 0 where accelerations cannot be solved for. */
static double distance(const Probe *p, double *base, double *moved) {
  double largest = 0.0, size = 1.0;
  for (int i = 0; i < p->count; i++) {
    largest = fmax(largest, fabs(p->seed[i]));
    size = fmax(size, fabs(instance_input(p->m, p->inputs[i])));
  }
  double by = PROBE * size / largest;
  if (move_inputs(p, 0.0)) return 0.0;
  measure(p->m, base);
  if (move_inputs(p, by)) return 0.0;
  measure(p->m, moved);
  double change = norm(base, moved);
  memset(moved, 0, UNKNOWNS * sizeof *moved);
  double motion = norm(base, moved);
  return change > 0.0 && motion > 0.0 ? by * PROBE * motion / change : by;
}

/* Derivatives of some outputs along a direction of some inputs; 0 if all went well. */
static int instance_derivatives(Instance *m, const int *outputs, int wanted, const int *inputs,
                                const double *seed, int count, double *to) {
  int failed = 1, moves = 0;
  if (m->failed) return 1;
  for (int i = 0; i < count; i++) moves |= seed[i] != 0.0;
  for (int i = 0; i < wanted; i++) to[i] = 0.0;
  if (!moves) return 0;
  double *space = malloc((2 * UNKNOWNS + 1 + (size_t)wanted) * sizeof *space);
  Probe probe = {m, malloc(STATE_BYTES), inputs, seed, count};
  if (space && probe.saved) {
    double *ahead = space + 2 * UNKNOWNS;
    instance_save(m, probe.saved);
    double by = distance(&probe, space, space + UNKNOWNS);
    failed = by == 0.0 || move_inputs(&probe, by);
    for (int i = 0; i < wanted && !failed; i++) ahead[i] = instance_output(m, outputs[i]);
    failed = failed || move_inputs(&probe, -by);
    for (int i = 0; i < wanted && !failed; i++)
      to[i] = (ahead[i] - instance_output(m, outputs[i])) / (2.0 * by);
    instance_restore(m, probe.saved);
  }
  if (failed)
    snprintf(m->message, sizeof m->message, "%s has no derivatives at t = %.9g: accelerations "
             "cannot be solved for there", MODEL_NAME, time_of(m));
  free(space);
  free(probe.saved);
  return failed;
}
