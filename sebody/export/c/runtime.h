/* Instances of an exported model. Each has memory of its own; nothing that is global is written.

   model.h has the numbers of the model: where arrays, inputs and outputs are in an instance's
   memory, its image. Compiled functions of the time loop read arrays through rows of words. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "inflate.h"
#include "model.h"

enum { DONE, CHUNK, FAILED, RAISED };                           /* what the loop returns */
enum { FACTORS, SOLUTION, READINGS };                           /* what it asks for */
enum { INPUT, ACCELERATION, PARAMETER };                        /* kinds of inputs */
#define ALIGNED 64
#define NEVER_RECORDED ((int64_t)1 << 60)
#define ON_GRID 1e-6    /* of a step: nearer times are on the grid */

extern int64_t sb_advance(void *system, void *state, void *record, const double *scheme,
                          int64_t last, int64_t chunk, int64_t dense);
extern int64_t sb_evaluate(void *system, void *state, void *outputs);
extern int64_t sb_exchange(void *system, void *state, void *exchanges, int64_t what);
extern int64_t sb_set_input(void *system, void *state, int64_t k, double value);
extern void *const sb_functions[];
extern const unsigned char sb_image[];

typedef struct {
  char *raw, *base, *factors;
  int64_t system[SYSTEM_WORDS], state[STATE_WORDS], outputs[OUTPUTS_WORDS], record[7], every;
  int64_t exchanges[EXCHANGES_WORDS];
  int stale, failed;
  char message[512];
} Instance;

static double *numbers(const Instance *m, int64_t at) { return (double *)(m->base + at); }
static int64_t *control(const Instance *m) { return (int64_t *)(m->base + AT_CONTROL); }
static double *clock_of(const Instance *m) { return numbers(m, AT_CLOCK); }
static double time_of(const Instance *m) { return clock_of(m)[CLOCK_TIME]; }

/* Words of a group of arrays: pointers are given as -1 - offset. */
static void place(Instance *m, int64_t *to, const int64_t *words, int count) {
  for (int i = 0; i < count; i++)
    to[i] = words[i] < 0 ? (int64_t)(intptr_t)(m->base - (words[i] + 1)) : words[i];
}

static int64_t aid(int64_t context, int64_t what);

static void instance_reset(Instance *m) {
  inflate(sb_image, (unsigned char *)m->base);
  memset(m->base + IMAGE_STORED, 0, IMAGE_SIZE - IMAGE_STORED);
  for (int i = 0; i < CALLED; i++)
    *(int64_t *)(m->base + CALLED_AT[i]) = (int64_t)(intptr_t)sb_functions[CALLED_FUNCTION[i]];
  int64_t *asked = (int64_t *)(m->base + AT_AID);
  asked[0] = (int64_t)(intptr_t)aid;
  asked[1] = (int64_t)(intptr_t)m;
  m->stale = 1;
  m->failed = 0;
  m->message[0] = 0;
}

static Instance *instance_new(void) {
  Instance *m = calloc(1, sizeof *m);
  if (!m) return 0;
  m->raw = malloc(IMAGE_SIZE + ALIGNED);
  if (!m->raw) { free(m); return 0; }
  m->base = (char *)(((uintptr_t)m->raw + ALIGNED - 1) & ~(uintptr_t)(ALIGNED - 1));
  place(m, m->system, SYSTEM, SYSTEM_WORDS);
  place(m, m->state, STATE, STATE_WORDS);
  place(m, m->outputs, OUTPUTS, OUTPUTS_WORDS);
  place(m, m->exchanges, EXCHANGES, EXCHANGES_WORDS);
  instance_reset(m);
  return m;
}

static void instance_free(Instance *m) {
  if (m) { free(m->factors); free(m->raw); free(m); }
}

static int fail(Instance *m, const char *why) {
  m->failed = 1;
  snprintf(m->message, sizeof m->message, "%s stopped at t = %.9g: %s", MODEL_NAME, time_of(m),
           why);
  return 1;
}

/* Read what sensors measure that the loop itself cannot read. */
static int read_sensors(Instance *m) {
  double *memory = numbers(m, AT_MEMORY);
  if (sb_evaluate(m->system, m->state, m->outputs))
    return fail(m, "what a sensor measures cannot be evaluated");
  for (int i = 0; i < SENSORS; i++)
    memory[SENSOR_PLACE[i]] = numbers(m, AT_VALUES)[SENSOR_OUTPUT[i]];
  return 0;
}

/* Factorize or solve with row exchanges. Room for factors is made where
   they are needed: their values and rows are the first two arrays of the words. */
static int exchange(Instance *m, int64_t what) {
  for (;;) {
    int64_t found = sb_exchange(m->system, m->state, m->exchanges, what);
    if (found != ROOM) return found ? fail(m, "compiled code failed") : 0;
    int64_t entries = ((int64_t *)(m->base + AT_KIND))[1];
    free(m->factors);
    m->factors = malloc((size_t)entries * (sizeof(double) + sizeof(int64_t)));
    if (!m->factors) {
      place(m, m->exchanges, EXCHANGES, EXCHANGES_WORDS);
      return fail(m, "there is no memory for a factorization");
    }
    int64_t at = (int64_t)(intptr_t)m->factors;
    m->exchanges[0] = at, m->exchanges[2] = at + entries * (int64_t)sizeof(double);
    m->exchanges[1] = m->exchanges[3] = entries;
  }
}

/* Give the loop of an instance what it lacks; 0 if all went well. */
static int64_t aid(int64_t context, int64_t what) {
  Instance *m = (Instance *)(intptr_t)context;
  return what == READINGS ? read_sensors(m) : exchange(m, what);
}

/* Call the loop until the step `last` of the grid, or for `chunk` steps; 0 if all went well. */
static int go(Instance *m, int64_t last, double *rows, int64_t count, int64_t chunk) {
  double none[1];
  int64_t words[] = {(int64_t)(intptr_t)(rows ? rows : none), rows ? count : 0, COLUMNS,
                     (int64_t)(intptr_t)&m->every, 1, (int64_t)(intptr_t)RECORD_AT, RECORD_PARTS};
  memcpy(m->record, words, sizeof words);
  m->every = rows ? 1 : NEVER_RECORDED;
  m->stale = 1;
  control(m)[CONTROL_RECORDED] = 0;
  int64_t code = sb_advance(m->system, m->state, m->record, SCHEME, last, chunk, DENSE);
  if (code == DONE || code == CHUNK) return 0;
  if (m->failed) return 1;      /* for want of what the loop asked for */
  int64_t reason = control(m)[CONTROL_REASON];
  return fail(m, code != FAILED || reason < 0 || reason >= REASONS ? "compiled code failed"
                 : REASON[reason]);
}

/* Let steps of fixed length end at a time off their grid, too; forget it with a negative time. */
static void set_corner(Instance *m, double t) {
  double *corners = numbers(m, AT_CORNERS);
  int64_t *jumps = (int64_t *)(m->base + AT_JUMPS);
  int k = 0, put = t < 0.0;
  for (int i = 0; i <= CORNERS; i++) {
    if (!put && (i == CORNERS || t < CORNER[i])) { corners[k] = t; jumps[k++] = 1; put = 1; }
    if (i < CORNERS) { corners[k] = CORNER[i]; jumps[k++] = CORNER_JUMPS[i]; }
  }
  if (k == CORNERS) { corners[k] = INFINITY; jumps[k] = 1; }
  control(m)[CONTROL_CORNER] = 0;
}

/* Let the next variable step end at a time at which something may be set. */
static void set_stop(Instance *m, double t) {
  double *memory = numbers(m, AT_MEMORY);
  memory[MEMORY_STOP] = memory[MEMORY_NEXT] = t;
  for (int k = 0; k < TASKS; k++) {
    double due = memory[MEMORY_COUNTS + k] * PERIOD[k];
    if (memory[MEMORY_NEXT] < 0.0 || due < memory[MEMORY_NEXT]) memory[MEMORY_NEXT] = due;
  }
}

/* Run to a time, which need not be on the grid of output. */
static int instance_run_to(Instance *m, double t) {
  double h = clock_of(m)[CLOCK_STEP], steps = t / h, now = time_of(m);
  if (m->failed) return 1;
  if (!(t >= now - ON_GRID * h) || !(steps < 1e15)) {
    snprintf(m->message, sizeof m->message, "%s cannot run to t = %.9g from t = %.9g", MODEL_NAME,
             t, now);
    return 1;
  }
  if (t <= now) return go(m, control(m)[CONTROL_GRID], 0, 0, 0);
  if (ADAPTIVE) {
    set_stop(m, t);
    while (time_of(m) < t)
      if (go(m, NEVER_RECORDED, 0, 0, 1)) return 1;
    return 0;
  }
  int64_t last = llround(steps);
  if (fabs(steps - (double)last) <= ON_GRID) return go(m, last, 0, 0, NEVER_RECORDED);
  last = (int64_t)floor(steps);
  if (last > control(m)[CONTROL_GRID] && go(m, last, 0, 0, NEVER_RECORDED)) return 1;
  set_corner(m, t);
  int failed = 0;
  while (!failed && time_of(m) < t - ON_GRID * h) failed = go(m, NEVER_RECORDED, 0, 0, 1);
  set_corner(m, -1.0);
  return failed;
}

/* Run some steps of the grid and record the state after each of them. */
static int instance_run(Instance *m, int64_t steps, double *rows) {
  if (m->failed) return 1;
  return go(m, control(m)[CONTROL_GRID] + steps, rows, steps, NEVER_RECORDED);
}

static double instance_input(const Instance *m, int k) {
  return INPUT_FACTOR[k] * *numbers(m, INPUT_AT[k]);
}

/* Numbers that follow from parameters, after one of these was set. */
static void set_parameters(Instance *m) {
  const double *values = numbers(m, AT_SETTINGS);
  for (int i = 0; i < SETTINGS; i++) {
    double sum = SETTING_OFFSET[i];
    for (int64_t j = SETTING_BEGINS[i]; j < SETTING_BEGINS[i + 1]; j++)
      sum += SETTING_SLOPE[j] * values[SETTING_BY[j]];
    *numbers(m, SETTING_AT[i]) = sum;
  }
}

/* Whether a value is none that an input can have; says so. */
static int instance_refuses(Instance *m, int k, double value) {
  if (isfinite(value) && value >= INPUT_LEAST[k] && value <= INPUT_MOST[k]) return 0;
  snprintf(m->message, sizeof m->message, "%s: %s is %g: give a finite value from %.6g to %.6g",
           MODEL_NAME, INPUT_NAME[k], value, INPUT_LEAST[k], INPUT_MOST[k]);
  return 1;
}

/* Set an input from now on: accelerations are solved for anew when the run goes on. */
static void instance_set(Instance *m, int k, double value) {
  if (value == instance_input(m, k)) return;
  int64_t *flags = control(m);
  if (INPUT_KIND[k] == INPUT) {
    if (!sb_set_input(m->system, m->state, INPUT_NUMBER[k], value)) return;
  } else if (INPUT_KIND[k] == ACCELERATION) {
    double *c = numbers(m, INPUT_AT[k]) - 2, *begun = numbers(m, INPUT_NUMBER[k]);
    double x = time_of(m) - *begun;
    c[0] += x * (c[1] + x * c[2]);
    c[1] += 2.0 * x * c[2];
    c[2] = 0.5 * value;
    *begun = time_of(m);
  } else {
    *numbers(m, INPUT_AT[k]) = value;
    set_parameters(m);
    flags[CONTROL_WANTED] = EVALUATED;
    if (KEEPS) *numbers(m, AT_FACTORS_VALID) = 0.0;
  }
  flags[CONTROL_RESTART] = ASKED;
  m->stale = 1;
}

/* Value of an output in the state reached; NaN if it cannot be evaluated. */
static double instance_output(Instance *m, int k) {
  if (m->stale) {
    if (sb_evaluate(m->system, m->state, m->outputs)) return NAN;
    m->stale = 0;
  }
  return numbers(m, AT_VALUES)[k];
}

/* A state as bytes, the same in every instance and process. */
typedef struct { uint64_t model; int64_t failed; } Header;
#define STATE_BYTES (sizeof(Header) + IMAGE_SAVED - IMAGE_MUTABLE)

static void instance_save(const Instance *m, char *to) {
  Header head = {MODEL_HASH, m->failed};
  memcpy(to, &head, sizeof head);
  memcpy(to + sizeof head, m->base + IMAGE_MUTABLE, IMAGE_SAVED - IMAGE_MUTABLE);
}

static int instance_restore(Instance *m, const char *from) {
  Header head;
  memcpy(&head, from, sizeof head);
  if (head.model != MODEL_HASH) {
    snprintf(m->message, sizeof m->message, "%s: this is not a state of this model", MODEL_NAME);
    return 1;
  }
  memcpy(m->base + IMAGE_MUTABLE, from + sizeof head, IMAGE_SAVED - IMAGE_MUTABLE);
  m->failed = (int)head.failed;
  m->stale = 1;
  ((int64_t *)(m->base + AT_KIND))[0] = 0;      /* factors are no part of a state: made again */
  return 0;
}
