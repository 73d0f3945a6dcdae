/* Decompression of the format deflate, RFC 1951. What is read was made with the library, so it is
   taken to be complete. */
#include <stdint.h>
#include <string.h>

enum { LONGEST_CODE = 15, LITERALS = 288, DISTANCES = 30, END = 256 };

typedef struct { const unsigned char *from; uint32_t bits; int count; } Bits;
/* A code by lengths: how many words of every length, and their symbols in the order of the words. */
typedef struct { uint16_t count[LONGEST_CODE + 1], symbols[LITERALS]; } Code;

static unsigned take(Bits *b, int n) {
  for (; b->count < n; b->count += 8) b->bits |= (uint32_t)*b->from++ << b->count;
  unsigned value = b->bits & ((1u << n) - 1);
  b->bits >>= n;
  b->count -= n;
  return value;
}

static void make_code(Code *code, const uint8_t *lengths, int n) {
  uint16_t next[LONGEST_CODE + 2] = {0};
  memset(code->count, 0, sizeof code->count);
  for (int i = 0; i < n; i++) code->count[lengths[i]]++;
  code->count[0] = 0;
  for (int k = 1; k <= LONGEST_CODE; k++) next[k + 1] = (uint16_t)(next[k] + code->count[k]);
  for (int i = 0; i < n; i++)
    if (lengths[i]) code->symbols[next[lengths[i]]++] = (uint16_t)i;
}

/* Words of one length are consecutive numbers: one is found when it is below the last of them. */
static int symbol(Bits *b, const Code *code) {
  int word = 0, first = 0, before = 0;
  for (int k = 1; k <= LONGEST_CODE; k++) {
    word += (int)take(b, 1);
    if (word < first + code->count[k]) return code->symbols[before + word - first];
    before += code->count[k];
    first = 2 * (first + code->count[k]);
    word *= 2;
  }
  return END;
}

/* The two codes of a block: fixed ones, or those written before it. */
static void read_codes(Bits *b, int fixed, Code *literals, Code *distances) {
  static const uint8_t order[] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  uint8_t lengths[LITERALS + 32] = {0};
  int n = LITERALS, m = DISTANCES, i = 0;
  if (fixed) {
    for (; i < n + m; i++) lengths[i] = i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : i < n ? 8 : 5;
  } else {
    n = (int)take(b, 5) + 257, m = (int)take(b, 5) + 1;
    int written = (int)take(b, 4) + 4;
    for (int k = 0; k < written; k++) lengths[order[k]] = (uint8_t)take(b, 3);
    make_code(literals, lengths, 19);
    while (i < n + m) {
      int one = symbol(b, literals), again = 1, length = one < 16 ? one : 0;
      if (one == 16) again = 3 + (int)take(b, 2), length = i ? lengths[i - 1] : 0;
      if (one == 17) again = 3 + (int)take(b, 3);
      if (one == 18) again = 11 + (int)take(b, 7);
      while (again-- && i < n + m) lengths[i++] = (uint8_t)length;
    }
  }
  make_code(literals, lengths, n);
  make_code(distances, lengths + n, m);
}

/* A number that a symbol stands for: groups of `group` symbols have one more bit each. */
static int number(Bits *b, int one, int group) {
  int more = one < 2 * group ? 0 : one / group - 1;
  int base = one < 2 * group ? one : ((one % group) + group) << more;
  return base + (int)take(b, more);
}

static void inflate(const unsigned char *from, unsigned char *to) {
  Bits b = {from, 0, 0};
  Code literals, distances;
  for (int last = 0; !last;) {
    last = (int)take(&b, 1);
    int kind = (int)take(&b, 2);
    if (kind == 0) {                    /* as it is, from the next whole byte */
      b.from -= b.count / 8, b.bits = 0, b.count = 0;
      size_t n = b.from[0] + 256u * b.from[1];
      memcpy(to, b.from + 4, n);
      to += n, b.from += 4 + n;
      continue;
    }
    read_codes(&b, kind == 1, &literals, &distances);
    for (int one; (one = symbol(&b, &literals)) != END;) {
      if (one < END) { *to++ = (unsigned char)one; continue; }
      int length = one == 285 ? 258 : 3 + number(&b, one - 257, 4);
      const unsigned char *old = to - 1 - number(&b, symbol(&b, &distances), 2);
      while (length--) *to++ = *old++;
    }
  }
}
