/* What a page calls beside libhooke (core/app/hooke/hooke.h): the user's hand, and the files of the plugins that are
 * linked in. Names begin with page_; engine.js is who calls. */
#include "tools/browser/run.h"
#include "tools/browser/linked.h"

#include <emscripten.h>

static hk_page_hand hand = {.strength = 1}; /* of the one run of this program */

const hk_page_hand *hk_page_hand_now(void) { return &hand; }

EMSCRIPTEN_KEEPALIVE void page_hold(uint32_t id, double x, double y, double z, double strength) {
  hand = (hk_page_hand){id, {x, y, z}, strength};
}

/* "forces/drag", for k = 0, 1, 2, ...; NULL: there are no more. */
EMSCRIPTEN_KEEPALIVE const char *page_plugin(size_t k) { return hk_linked_plugins[k].file; }
