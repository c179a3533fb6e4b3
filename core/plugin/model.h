/* Who is in a scene: what is constant during a step. Comes with core/plugin.h, as the other headers of this folder. */
#ifndef HK_PLUGIN_MODEL_H
#define HK_PLUGIN_MODEL_H

typedef enum hk_pin {
  HK_FREE,
  HK_PIN_FIXED,
  HK_PIN_PATH, /* follows a script; F on it changes nothing */
  HK_PIN_LINE, /* slides along a line */
  HK_PIN_PLANE /* slides in a plane */
} hk_pin;

typedef struct hk_channel {
  const char *name;
  size_t size;   /* numbers per particle */
  size_t offset; /* its values are y + offset * n, n x size */
} hk_channel;

/* A field that a plugin publishes (HK_PUBLISHED): a density, a number of neighbours, as of its last evaluation. */
typedef struct hk_publication {
  const char *name;            /* of the field */
  const char *label;           /* of the plugin */
  size_t width;                /* numbers per particle */
  const double *const *values; /* *values: n x width */
} hk_publication;

struct hk_model {
  size_t n;
  const double *mass;         /* n, kg */
  const double *inverse_mass; /* n, 1/kg; 0 for HK_PIN_FIXED and HK_PIN_PATH */
  const uint32_t *id;         /* n, from 1, increasing */
  const uint32_t *group;      /* n, position in group_name */
  const uint8_t *pin;         /* n, hk_pin */
  size_t groups;
  const char *const *group_name;
  size_t channels;
  const hk_channel *channel;
  hk_tuples edges, triangles; /* the scene's, of builders' grids, strands and meshes: for pictures and collisions */
  size_t element_lists;       /* of the forces that offer their elements */
  const struct hk_element_list *element_list;
  size_t publications;
  const hk_publication *published;
};

#endif
