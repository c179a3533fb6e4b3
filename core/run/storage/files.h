/* Declarations shared by the files of core/run/storage. */
#ifndef HK_STORAGE_FILES_H
#define HK_STORAGE_FILES_H

#include "core/numerics/population/population.h"
#include "core/run/storage/storage.h"

/* Sets the error "cannot read FILE: reason" by errno. */
hk_status hk_io_error(hk_error *, const char *doing, const char *path);
/* Replaces the particles of the run by the set, in the state and wherever indices are stored. */
hk_status hk_install(hk_loop *, hk_particle_set *);

/* `origin` NULL: it may be one of another scene. */
hk_status hk_checkpoint_read(hk_loop *, hk_judgement *, const char *path, const char *origin,
                             hk_origin_changes *changes);
hk_status hk_state_table_read(const hk_scene *, hk_loop *, FILE *, const char *begun, const char *path);
extern const char hk_checkpoint_magic[];

#endif
