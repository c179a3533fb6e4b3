/* Reading HDF5 files from strangers. All of it comes from the one file that was opened: groups and datasets behind soft
 * or external links count as missing, and so do datasets whose numbers lie in other files (external storage, virtual
 * datasets). Types, ranks and sizes are checked before anything is read, and a dataset that claims to hold more than
 * its stored bytes can, so that memory for it would be a trap, is refused; and so are filters other than those that
 * hooke writes with. */
#ifndef HK_H5_READING_H
#define HK_H5_READING_H

#include <hdf5.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Read only. Negative: it is not there, no whole HDF5 file, or no plain file (a pipe, a folder). */
hid_t hk_h5_open_file(const char *path);

/* To be closed with H5Gclose; negative: there is no such group in this file. `path` may have several parts. */
hid_t hk_h5_open_group(hid_t at, const char *path);
/* To be closed with H5Dclose; negative: there is no such dataset of numbers or text in this file. */
hid_t hk_h5_open_set(hid_t at, const char *path);
bool hk_h5_has(hid_t at, const char *path); /* a hard link */
/* The bytes of the file that the dataset takes; those of all datasets of a file are at most as many as it has, unless
 * some share theirs. 0: it claims more than the file has. */
hsize_t hk_h5_stored(hid_t set);

/* Rows and columns; one column where there is no second dimension. False: it has more dimensions, or set is negative.
 */
bool hk_h5_size(hid_t set, hsize_t size[2]);
/* Whether the set has rows at, ..., at + rows - 1. */
bool hk_h5_has_rows(hid_t set, int64_t at, int64_t rows);
/* Rows of a dataset of `width` numbers each; width 0: it has no second dimension. False: it has not so many. */
bool hk_h5_get_rows(hid_t set, int64_t at, size_t rows, size_t width, hid_t type, void *to);
/* The whole of a dataset of numbers with these rows and columns, in fresh memory; NULL: it has others. */
void *hk_h5_get_list(hid_t at, const char *path, hid_t type, hsize_t rows, hsize_t columns, size_t item);
/* A dataset that is one text of fixed length, in fresh memory; "" where there is none. NULL: no memory, or
 * it is something else. */
char *hk_h5_get_long_text(hid_t at, const char *path);

/* Attributes: one text of fixed length, of which what is longer than the room is cut; one number. */
bool hk_h5_get_text(hid_t object, const char *name, char *to, size_t size);
bool hk_h5_get_number(hid_t object, const char *name, hid_t type, void *to);

#endif
