/* @NAME@: a model as a library, made by sebody @VERSION@.
   Link with the library beside this file, in the folder of your platform.

   Instances share nothing: several may run at the same time in different threads.
   Functions that return int give 0 if all went well; @ID@_error says what went wrong otherwise.
   Units are those of the model. */
#ifndef @ID@_h
#define @ID@_h
#include <stddef.h>
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif

typedef struct @ID@ @ID@;

#define @ID@_STEP @STEP@      /* of the output grid */
#define @ID@_COLUMNS @COLUMNS@        /* numbers in a row of recorded states */

/* Inputs: what @ID@_set sets. */
@INPUTS@
/* Outputs: what @ID@_get gives. */
@OUTPUTS@
/* A new instance at t = 0; a null pointer if there is no memory. */
@ID@ *@ID@_new(void);
void @ID@_free(@ID@ *model);

/* Back to t = 0, with the inputs of the start. */
void @ID@_reset(@ID@ *model);

/* Run some output steps; `rows` takes the state after each of them, steps x COLUMNS numbers:
@ROW@ */
int @ID@_run(@ID@ *model, int64_t steps, double *rows);

/* Run to any time later than the one reached. */
int @ID@_run_to(@ID@ *model, double t);

double @ID@_time(const @ID@ *model);

/* Set an input: it holds from the time reached until it is set again. */
int @ID@_set(@ID@ *model, int input, double value);

/* An output in the state reached. */
double @ID@_get(@ID@ *model, int output);

/* Derivative of an output by an input, at the time reached: what changes at once, with positions,
   velocities and states of controllers as they are. The model stays as it is. */
int @ID@_derivative(@ID@ *model, int output, int input, double *value);

/* The last error in words. */
const char *@ID@_error(const @ID@ *model);

/* The state as bytes, which other instances and processes can restore. */
size_t @ID@_state_size(void);
void @ID@_save(const @ID@ *model, void *to);
int @ID@_restore(@ID@ *model, const void *from);

#ifdef __cplusplus
}
#endif
#endif
