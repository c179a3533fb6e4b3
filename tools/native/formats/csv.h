/* A table of particles: a row for each particle of each frame (RFC 4180). */
#ifndef HK_CSV_H
#define HK_CSV_H

#include "plugins/common/frame_data/frame_data.h"

#include <stdio.h>

void hk_csv_head(FILE *, const hk_frame_data *);
void hk_csv_rows(FILE *, const hk_frame_data *);

#endif
