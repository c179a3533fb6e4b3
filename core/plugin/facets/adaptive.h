/* Facet of a method with HK_ADAPTIVE for which the usual tolerance, 1e-6, is not worth its cost. */
#ifndef HK_PLUGIN_ADAPTIVE_H
#define HK_PLUGIN_ADAPTIVE_H

#include <stddef.h>

#define HK_ADAPTIVE_ID "adaptive/1"

typedef struct hk_adaptive_facet {
  size_t size;
  double tolerance; /* hk_system.tol where nobody asks for one: what the order makes worth while. Required. */
} hk_adaptive_facet;

#endif
