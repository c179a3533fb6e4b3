/* An HDF5 file that is whole at every moment: what the library writes is kept in memory until a commit, which puts it
 * into the file in an order in which each state between is a file that any program can read. A process that is killed
 * leaves the file of its last commit. A full disk is met by the commit alone, so the library never sees it. */
#ifndef HK_H5_FILE_H
#define HK_H5_FILE_H

#include <hdf5.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct hk_h5_file hk_h5_file;

/* Creates the file, under its name only when it is sealed: no moment has an empty one, and what has the name until
 * then, a link or a pipe perhaps, makes room. NULL with errno. */
hk_h5_file *hk_h5_create(const char *path);
hid_t hk_h5_id(const hk_h5_file *);
/* From here on no group, dataset or attribute is added, and the order of the library's writes is safe. */
bool hk_h5_seal(hk_h5_file *);
/* All that was written so far goes to the file. False: hk_h5_cause has the reason; the file stays as it is. */
bool hk_h5_commit(hk_h5_file *);
/* Commits and frees. *cause: 0, or an errno that this or an earlier commit met. */
void hk_h5_close(hk_h5_file *, int *cause);
int hk_h5_cause(const hk_h5_file *); /* errno; EIO where the library itself failed */

#endif
