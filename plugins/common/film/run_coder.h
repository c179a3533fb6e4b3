/* Deflate (RFC 1951) for rows of rendered pictures, which after PNG's filter are runs of one byte and little else: the
 * only matches that are looked for are those of the byte before. One block, with a prefix code from a sample of the
 * rows. */
#ifndef HK_RUN_CODER_H
#define HK_RUN_CODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HK_LITERALS = 286, HK_LONGEST_RUN = 258, HK_LONGEST_CODE = 15 };

typedef struct hk_run_coder {
  uint32_t count[HK_LITERALS];                                    /* of the sample */
  uint8_t length[HK_LITERALS];                                    /* of a code, bits */
  uint16_t code[HK_LITERALS];                                     /* the first bit is the lowest */
  uint32_t run[HK_LONGEST_RUN + 1], run_bits[HK_LONGEST_RUN + 1]; /* what stands for a run of this length, from 3 on */
  uint64_t bits;                                                  /* that wait for their byte */
  unsigned waiting;
} hk_run_coder;

/* Counts what a row consists of; a zeroed coder has counted none. */
void hk_run_coder_sample(hk_run_coder *, const uint8_t *row, size_t bytes);
/* Chooses the code, and writes the head of the block, at most 256 bytes, to `out`. Each returns the end of the output.
 */
uint8_t *hk_run_coder_begin(hk_run_coder *, uint8_t *out);
/* At most 2 bytes for each of the row's, and 8. */
uint8_t *hk_run_coder_row(hk_run_coder *, const uint8_t *row, size_t bytes, uint8_t *out);
/* At most 16 bytes. */
uint8_t *hk_run_coder_end(hk_run_coder *, uint8_t *out);

#endif
