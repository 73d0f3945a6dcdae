/* What compiled functions ask of the run-time of Numba: memory with a count of references, strides. */
#include <stdint.h>
#include <stdlib.h>

typedef struct {
  size_t references;
  void (*destroy)(void *, size_t, void *);
  void *info, *data;
  size_t size;
  void *external;
} MemInfo;

#define LOCAL __attribute__((visibility("hidden")))

LOCAL MemInfo *NRT_MemInfo_alloc_aligned(size_t size, uint32_t align) {
  char *raw = malloc(sizeof(MemInfo) + size + align);
  if (!raw) return 0;
  MemInfo *m = (MemInfo *)raw;
  uintptr_t first = ((uintptr_t)(raw + sizeof *m) + align - 1) / align * align;
  *m = (MemInfo){1, 0, 0, (void *)first, size, 0};
  return m;
}
LOCAL MemInfo *NRT_MemInfo_alloc_safe_aligned(size_t size, uint32_t align) {
  return NRT_MemInfo_alloc_aligned(size, align);
}
LOCAL void NRT_MemInfo_call_dtor(MemInfo *m) { free(m); }
LOCAL void NRT_Free(void *memory) { free(memory); }
LOCAL void NRT_incref(MemInfo *m) {
  if (m) m->references++;
}
LOCAL void NRT_decref(MemInfo *m) {
  if (m && --m->references == 0) free(m);
}

/* New strides of an array that lies in memory without gaps, row after row; 0 of any other. */
LOCAL int numba_attempt_nocopy_reshape(intptr_t count, const intptr_t *sizes,
                                       const intptr_t *strides, intptr_t new_count,
                                       const intptr_t *new_sizes, intptr_t *new_strides,
                                       intptr_t item, int by_columns) {
  intptr_t stride = item;
  if (by_columns) return 0;
  for (intptr_t k = count; k-- > 0; stride *= sizes[k])
    if (sizes[k] != 1 && strides[k] != stride) return 0;
  stride = item;
  for (intptr_t k = new_count; k-- > 0; stride *= new_sizes[k]) new_strides[k] = stride;
  return 1;
}
