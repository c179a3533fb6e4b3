/* How particles appear in pictures: which quantity their colour, radius and opacity show, as a scene says it by names.
 */
#ifndef HK_APPEARANCE_H
#define HK_APPEARANCE_H

#include "plugins/common/frame_data/radii.h"

typedef enum hk_paint {
  HK_PAINT_TENSION, /* as the next two, in the order of hk_stress_kind (stress/stress.h) */
  HK_PAINT_SHEET_STRESS,
  HK_PAINT_SOLID_STRESS,
  HK_PAINT_NONE,    /* one colour for all */
  HK_PAINT_STRAIN,  /* of the elements of a particle the largest by magnitude (frame_data/strain.h) */
  HK_PAINT_SPEED,   /* |v|, m/s */
  HK_PAINT_GROUP,   /* a colour per group */
  HK_PAINT_AGE,     /* s since the birth */
  HK_PAINT_MASS,    /* kg */
  HK_PAINT_CHANNEL, /* a channel's number, or the length of its vector */
  HK_PAINT_RGB      /* a channel of three numbers in 0..1: red, green, blue */
} hk_paint;

typedef enum hk_sizes {
  HK_SIZE_SAME,
  HK_SIZE_MASS,   /* radii as the cube roots of the masses */
  HK_SIZE_CHANNEL /* a channel's number is the radius, m */
} hk_sizes;

typedef struct hk_appearance_names { /* as the script writes them */
  const char *color; /* auto, none, strain, tension, stress, sheet_stress, solid_stress, speed, group, age, mass, or a
                        channel, which goes before those */
  const char *size;  /* auto: the channel radius if there is one; same, mass, or a channel */
  const char *fade;  /* a channel, or NULL */
  const char *tubes; /* a channel, or groups with radii, "rope 0.01, thread 0.002"; NULL: what contact publishes, and
                        elsewhere the strands' own; "": all are the same */
} hk_appearance_names;

enum { HK_TUBE_GROUPS = 16 };

typedef struct hk_appearance {
  hk_paint paint;
  hk_sizes sizes;
  bool fades, tubes;                                        /* tubes: strands have radii of their own */
  size_t channel, size_channel, fade_channel, tube_channel; /* positions in model->channel */
  hk_strand_radii radii;                                    /* none where others are wanted */
  size_t tube_groups;                                       /* 0: the channel has it, or those have */
  struct {
    uint32_t group;
    double radius; /* m */
  } tube_group[HK_TUBE_GROUPS];
  int springs, particles; /* 0 auto: those not shown by other objects; 1 all; 2 none */
  double streak;          /* s: particles leave a streak of this much of their way */
  bool y_up;
} hk_appearance;

/* Whether colours are of elements, with numbers on both sides of 0. */
static inline bool hk_paints_elements(hk_paint paint) {
  return paint <= HK_PAINT_SOLID_STRESS || paint == HK_PAINT_STRAIN;
}

/* Sets what the names say. HK_BAD_PARAM: unknown name; the message has the nearest. `whole`: the model has its
 * elements, so that `stress` is that of what the scene has, and a scene that has nothing of the kind is refused.
 * `label`: name and unit of the colours' numbers (the host owns a channel's name). */
hk_status hk_appearance_choose(hk_appearance *, const hk_host *host, const hk_model *model, bool whole,
                               const hk_appearance_names *, const char **label);

/* From the scene's axes to those of pictures, in which z is up. */
static inline void hk_to_z_up(bool y_up, const double in[3], double out[3]) {
  double y = in[1], z = in[2];
  out[0] = in[0], out[1] = y_up ? -z : y, out[2] = y_up ? y : z;
}

#endif
