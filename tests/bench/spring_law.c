/* What spring_paths.c measures, of springs with a law of their own, as a plugin outside the tree would have them: a
 * tension k (l - L) (1 + b (l - L)^2). */
#define HK_SPRING_TENSION(k, L, l) ((k) * ((l) - (L)) * (1 + ((l) - (L)) * ((l) - (L)) * 25.))
#include "tests/bench/spring_paths.c"
