/* What the page tells of the user's hand (engine.js), and what its output reads. */
#ifndef HK_BROWSER_RUN_H
#define HK_BROWSER_RUN_H

#include <stdint.h>

typedef struct hk_page_hand {
  uint32_t id; /* of the particle that is held; 0: none */
  double place[3], strength;
} hk_page_hand;

const hk_page_hand *hk_page_hand_now(void);

#endif
