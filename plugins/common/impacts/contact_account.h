/* What a corrector of contact has done in a run: impulses, energy, the least gap. A step counts once the next one
 * starts at its end: until then another corrector may take it back. */
#ifndef HK_CONTACT_ACCOUNT_H
#define HK_CONTACT_ACCOUNT_H

#include "plugins/common/surfaces/surfaces.h"

typedef struct hk_contact_sums {
  double impulse, energy; /* N s, J */
  double closest;         /* m */
} hk_contact_sums;

typedef struct hk_contact_account {
  hk_contact_sums settled, last; /* of the last step, which ended at last_t; `closest`: since the last report */
  double last_t;                 /* s */
  double *free;                  /* 2 x n x 3: positions and velocities before the corrections */
} hk_contact_account;

#define HK_CONTACT_ACCOUNT_ROWS(TYPE, MEMBER)                                                                          \
  {"impulse", HK_FIELD_NUMBER, 1, offsetof(TYPE, MEMBER.settled.impulse), 0},                                          \
      {"energy", HK_FIELD_NUMBER, 1, offsetof(TYPE, MEMBER.settled.energy), 0},                                        \
      {"closest", HK_FIELD_NUMBER, 1, offsetof(TYPE, MEMBER.settled.closest), 0},                                      \
      {"last_impulse", HK_FIELD_NUMBER, 1, offsetof(TYPE, MEMBER.last.impulse), 0},                                    \
      {"last_energy", HK_FIELD_NUMBER, 1, offsetof(TYPE, MEMBER.last.energy), 0},                                      \
      {"last_closest", HK_FIELD_NUMBER, 1, offsetof(TYPE, MEMBER.last.closest), 0}, {                                  \
    "last_t", HK_FIELD_NUMBER, 1, offsetof(TYPE, MEMBER.last_t), 0                                                     \
  }

void hk_contact_account_begin(hk_contact_account *, double t);
/* In `create` and `topology`. HK_NO_MEMORY. */
hk_status hk_contact_account_open(hk_contact_account *, const hk_host *, size_t n);
/* Before a step of h s that ends at t: settles the last one, or drops it. */
void hk_contact_account_step(hk_contact_account *, double t, double h);
/* Keeps the end of the step as it is now. */
void hk_contact_account_free(hk_contact_account *, const hk_view *, const hk_correction *);
/* After all corrections: sets the correction's work, the change of the kinetic energy at the end of the step less what
 * the accelerations of the step do over the way between its two ends: the energy lost in impacts and to friction, and
 * what moving obstacles give. */
void hk_contact_account_work(hk_contact_account *, const hk_view *, hk_correction *);
bool hk_contact_account_report(hk_contact_account *, const hk_surfaces *, const hk_view *, hk_contact_report *out);

#endif
