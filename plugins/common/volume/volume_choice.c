#include "plugins/common/volume/volume_choice.h"

hk_status hk_volumes_choose(const hk_host *host, const hk_volume_optics *optics, bool y_up, const hk_volumes **all) {
  *all = NULL;
  if (isnan(optics->extinction))
    return optics->glow > 0
               ? host->fail(host, HK_BAD_PARAM, "glow: gas is drawn where smoke is given; it may be 0 m^2/kg")
               : HK_OK;
  *all = host->query(host, HK_VOLUMES_INTERFACE);
  if (!*all || (*all)->count == 0)
    return host->fail(host, HK_BAD_PARAM, "smoke: the scene has no gas; add the corrector gas, or leave it out");
  if (y_up) return host->fail(host, HK_BAD_PARAM, "smoke: it is drawn with z up alone; leave up out");
  return HK_OK;
}

hk_status hk_volumes_check(const hk_host *host, const hk_volumes *all, bool waiting) {
  if (!all || !waiting) return HK_OK;
  return host->fail(host, HK_BAD_PARAM,
                    "smoke: its pictures are drawn as the run goes on: give from, look_at and ground_height (or "
                    "ground = false), color = \"none\" or a range, to lights an opacity, and leave out sheet, views "
                    "and follow");
}
