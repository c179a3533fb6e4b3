/* Reading rows of datasets, and texts. */
#ifndef HK_H5_ROWS_H
#define HK_H5_ROWS_H

#include <hdf5.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Rows of a dataset of `width` numbers each; width 0: it has no second dimension. False: it has not so many. */
bool hk_h5_get_rows(hid_t set, int64_t at, size_t rows, size_t width, hid_t type, void *to);
/* Of an attribute of fixed length; what is longer than the room is cut. */
bool hk_h5_get_text(hid_t object, const char *name, char *to, size_t size);

#endif
