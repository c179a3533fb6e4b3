/* The model of a scene: the data of its particles that are constant during a step. core/plugin.h includes this header,
 * like the others of this folder. */
#ifndef HK_PLUGIN_MODEL_H
#define HK_PLUGIN_MODEL_H

typedef enum hk_pin {
  HK_FREE,
  HK_PIN_FIXED,
  HK_PIN_PATH,  /* follows a path of the script; forces on it have no effect */
  HK_PIN_LINE,  /* slides along a line */
  HK_PIN_PLANE, /* slides in a plane */
  HK_PIN_RIDES  /* is carried by others, see hk_rider; forces on it act on these */
} hk_pin;

/* A particle without mass whose place is a fixed linear combination of those of others, x = sum of weight[k] x of
 * carrier[k], and so is its velocity: a point of a rigid body. The host puts it there, wherever it imposes pins, and
 * carries what acts on it over to the carriers: forces by F of carrier[k] += weight[k] F, Jacobians and the gradients
 * of equations likewise. The carriers are no riders. */
enum { HK_CARRIERS = 4 };
typedef struct hk_rider {
  uint32_t particle, carriers; /* its index; 1 to HK_CARRIERS of them */
  uint32_t carrier[HK_CARRIERS];
  double weight[HK_CARRIERS]; /* with the sum 1 */
  bool touches;               /* it is of the surface of its body, see hk_model.inside */
  bool meets; /* of a joint whose bodies meet: the pairs of `join` that it is in say nothing else; since minor 4 */
  /* The ids of the points of a joint, from `joined` on so many: contact takes none of them, and leaves out pairs of the
   * bodies that they are of with the body of this one. 0: none; since minor 3. */
  uint8_t joints;
  uint32_t joined;
  double radius; /* m, of a round point of the surface; 0: what contact says of such points */
} hk_rider;

/* The surface of a body, for pictures: its triangles in a frame whose origin, and whose unit points of the three axes,
 * are fixed linear combinations of particles. */
typedef struct hk_body_skin {
  uint32_t carriers, carrier[HK_CARRIERS];
  double origin[HK_CARRIERS], axis[3][HK_CARRIERS]; /* weights; of an axis with the sum 0 */
  size_t vertices, triangles;
  const double *vertex;          /* vertices x 3, m, in that frame */
  const uint32_t (*triangle)[3]; /* anticlockwise, seen from outside */
} hk_body_skin;

typedef struct hk_channel {
  const char *name;
  size_t size;   /* numbers per particle */
  size_t offset; /* its values are y + offset * n, n x size */
} hk_channel;

/* A field that a plugin publishes (HK_PUBLISHED), such as a density or a number of neighbours, with the values of its
 * last evaluation. The field of a force has its present values when forces further down in the scene are evaluated.
 * Publications are listed before the first `create` (those of a service after the last): find them there and keep
 * `values`, which stays valid; the address *values changes when particles are born or die. */
typedef struct hk_publication {
  const char *name;            /* name of the field */
  const char *label;           /* label of the plugin */
  size_t width;                /* numbers per particle */
  const double *const *values; /* *values: n x width; NULL before the plugin's own `create` */
} hk_publication;

/* A box that repeats along some axes: a particle at x is also at x + k (high - low) along each of them, for every whole
 * k. Positions are those of one of these images and are never wrapped: a particle that leaves through a face goes on,
 * so that its way, its work and what joins it to others need nothing new. What acts between particles that are not
 * joined takes the nearest image of the other, hk_nearest_image. */
typedef struct hk_periodic_box {
  double low[3], high[3]; /* m */
  bool repeats[3];
} hk_periodic_box;

/* A further flag of forces, constraints and correctors: in a periodic box the plugin acts between nearest images, or
 * what it does is the same without. Of one without it the run warns, unless it is a force that does not depend on x, or
 * acts on tuples of the script's, whose members are where they are. */
enum { HK_PERIODIC = 65536 };

struct hk_model {
  size_t n;
  const double *mass;         /* n, kg */
  const double *inverse_mass; /* n, 1/kg; 0 for HK_PIN_FIXED and HK_PIN_PATH */
  const uint32_t *id;         /* n, from 1; not in order where the host has renumbered the particles, see by_id */
  const uint32_t *group;      /* n, position in group_name */
  const uint8_t *pin;         /* n, hk_pin */
  size_t groups;
  const char *const *group_name;
  size_t channels;
  const hk_channel *channel;
  hk_tuples edges, triangles; /* of the scene's grids, strands and meshes, for pictures and collisions */
  size_t element_lists;       /* number of lists, one for each force with elements */
  const struct hk_element_list *element_list;
  size_t publications;
  const hk_publication *published;
  size_t join_lists; /* number of lists of pairs that constraints join, for pictures */
  const hk_tuples *const *join;
  /* n: the indices of the particles in the order of their ids. NULL: ids rise with the index. The host may give
   * neighbours indices that are close to each other; what users see goes by the id. */
  const uint32_t *by_id;
  const struct hk_partition *partition; /* core/plugin/parts.h; changes with n */
  double t; /* s, of the last accepted state: what a force remembers of a step's beginning is from then */
  const hk_periodic_box *box; /* NULL: space is open; since minor 1 */
  size_t riders;              /* since minor 1, as what follows */
  const hk_rider *rider;      /* by rising particle */
  size_t skins;
  const hk_body_skin *skin;
  /* n: within a rigid body, where contact does not take it: what has the body's mass, and points that are not of its
   * surface (hk_rider.touches). NULL: there are none. */
  const bool *inside;
  /* The first so many of the `join` lists are of constraints that keep their pairs as they are (HK_DISTANCES,
   * HK_DIFFERENCES); since minor 4. */
  size_t kept_lists;
};

/* Whether the particle can move, by itself or with what carries it. */
static inline bool hk_model_moves(const hk_model *m, size_t particle) {
  return m->inverse_mass[particle] > 0 || (m->riders > 0 && m->pin[particle] == HK_PIN_RIDES);
}

/* Whether it moves and contact takes it. */
static inline bool hk_model_touches(const hk_model *m, size_t particle) {
  return hk_model_moves(m, particle) && !(m->inside && m->inside[particle]);
}

/* d, the difference of two positions, becomes that to the nearest image: at most half of the box along each axis that
 * repeats. The opposite difference becomes the opposite, bit by bit, but for ties. */
static inline void hk_nearest_image(const hk_periodic_box *box, double d[3]) {
  const double whole = 6755399441055744; /* 1.5 2^52: what is added to it is rounded to a whole number */
  for (int c = 0; c < 3; c++) {
    double length = box->high[c] - box->low[c];
    if (box->repeats[c]) d[c] -= length * ((d[c] / length + whole) - whole);
  }
}

/* The index of the k-th particle in the order of ids, k < n. */
static inline size_t hk_model_nth(const hk_model *m, size_t k) { return m->by_id ? m->by_id[k] : k; }

/* What carries the particle of that index; NULL: it is no rider. */
static inline const hk_rider *hk_model_rider(const hk_model *m, size_t particle) {
  size_t low = 0, high = m->riders;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (m->rider[middle].particle < particle)
      low = middle + 1;
    else
      high = middle;
  }
  return low < m->riders && m->rider[low].particle == particle ? &m->rider[low] : NULL;
}

/* The index of the particle with that id; m->n: there is none. */
static inline size_t hk_model_find(const hk_model *m, uint32_t id) {
  size_t low = 0, high = m->n;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (m->id[hk_model_nth(m, middle)] < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low < m->n && m->id[hk_model_nth(m, low)] == id ? hk_model_nth(m, low) : m->n;
}

#endif
