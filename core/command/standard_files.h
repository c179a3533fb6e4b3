/* Standard input, output and error. */
#ifndef HK_STANDARD_FILES_H
#define HK_STANDARD_FILES_H

#include "core/base/base.h"

/* Before any file is opened. HK_IO: the process may not open as many as hooke needs. */
hk_status hk_standard_files_open(hk_error *error);
/* At the end: whether all that was printed has been written. */
hk_status hk_standard_output_end(hk_error *error);

#endif
