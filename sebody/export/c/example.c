/* Runs the model: example [STEPS [FILE]] prints the outputs of some output steps, and with FILE
   writes the recorded rows to it, as numbers of eight bytes.

   Compile, with FOLDER the one of your platform:
     cc example.c -I. -LFOLDER -l@ID@ -Wl,-rpath,FOLDER -o example */
#include <stdio.h>
#include <stdlib.h>
#include "@ID@.h"

static const char *const OUTPUTS[] = {@NAMES@"t"};

static int failed(@ID@ *model) {
  fprintf(stderr, "%s\n", @ID@_error(model));
  @ID@_free(model);
  return 1;
}

/* Step by step, as a program with a loop of its own does: set inputs, run, get outputs. */
static int print_outputs(@ID@ *model, int64_t steps) {
  int outputs = (int)(sizeof OUTPUTS / sizeof *OUTPUTS) - 1;
  for (int64_t k = 1; k <= steps; k++) {
    if (@ID@_run_to(model, (double)k * @ID@_STEP)) return 1;
    printf("t = %.9g", @ID@_time(model));
    for (int i = 0; i < outputs; i++) printf(", %s = %.17g", OUTPUTS[i], @ID@_get(model, i));
    printf("\n");
  }
  return 0;
}

/* All steps at once, with the state after each of them. */
static int write_rows(@ID@ *model, int64_t steps, const char *path) {
  double *rows = malloc((size_t)steps * @ID@_COLUMNS * sizeof *rows);
  if (!rows || @ID@_run(model, steps, rows)) return 1;
  FILE *file = fopen(path, "wb");
  size_t written = file ? fwrite(rows, sizeof *rows * @ID@_COLUMNS, (size_t)steps, file) : 0;
  if (file) fclose(file);
  free(rows);
  return written != (size_t)steps;
}

int main(int count, char **given) {
  int64_t steps = count > 1 ? strtoll(given[1], NULL, 10) : 10;
  @ID@ *model = @ID@_new();
  if (!model) return 1;
  if (count > 2 ? write_rows(model, steps, given[2]) : print_outputs(model, steps))
    return failed(model);
  @ID@_free(model);
  return 0;
}
