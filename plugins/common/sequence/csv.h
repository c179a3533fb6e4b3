/* A table of particles: a row for each particle of each frame (RFC 4180). */
#ifndef HK_SHOT_CSV_H
#define HK_SHOT_CSV_H

#include "plugins/common/shot/shot.h"

#include <stdio.h>

void hk_shot_csv_head(FILE *, const hk_shot *);
void hk_shot_csv_rows(FILE *, const hk_shot *);

#endif
