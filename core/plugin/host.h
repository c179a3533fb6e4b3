/* What the host does for a plugin. core/plugin.h includes this header, like the others of this folder. */
#ifndef HK_PLUGIN_HOST_H
#define HK_PLUGIN_HOST_H

/* Host services, one table per instance. */
struct hk_host {
  unsigned abi;
  int lanes; /* doubles of the widest vectors that this processor has and this run may use: 2, 4 or 8, for HK_WIDEST
                (core/plugin/widest.h); results have the same bits for each, unless a plugin says otherwise */
  /* Records the message ("%s" etc. as printf) under the instance's label and script line; returns `status`. */
  hk_status (*fail)(const hk_host *, hk_status status, const char *format, ...) HK_PRINTF(3, 4);
  /* A warning: shown once per text, listed in the summary. */
  void (*warn)(const hk_host *, const char *format, ...) HK_PRINTF(2, 3);
  /* Zeroed memory, 64-byte aligned; NULL: no memory. The host frees memory that is not released after `destroy`. */
  void *(*allocate)(const hk_host *, size_t bytes);
  void (*release)(const hk_host *, void *memory);
  /* Calls body(context, begin, end, chunk) for the chunks [chunk*grain, ...) of 0..count, on several threads. How the
   * range is cut depends on count and grain alone, so a sum over chunks in order is the same for any thread count. A
   * body may call it too: that loop runs in the body's own thread, its chunks in order. */
  void (*parallel_for)(const hk_host *, size_t count, size_t grain,
                       void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context);
  /* Uniform in [0, 1), 53 bits, from the instance's own stream (seeded by --seed, kind and label; in checkpoints). */
  double (*random)(const hk_host *);
  /* Outputs: the path of a file of this run, below its output folder, where folders in `name` are created. HK_IO when
   * that fails, HK_BAD_PARAM when `name` is absolute, has "..", or is another output's: ask early, in `open`. */
  hk_status (*path)(const hk_host *, const char *name, char *buffer, size_t size);
  /* A table of further services by versioned name, "neighbours/1" (core/plugin/service.h); to be queried in `create`,
   * valid as long as the run. NULL: no service has this name. */
  const void *(*query)(const hk_host *, const char *service);
  /* Changes the length of an array among the fields of this instance: items are kept, new ones zeroed. HK_NO_MEMORY:
   * the field does not change. Must not be called during evaluations. */
  hk_status (*resize)(const hk_host *, hk_array *field, size_t count);
  /* Calls a function of the script, which has to give n_out finite numbers; never from a body of parallel_for. */
  hk_status (*call)(const hk_host *, const hk_function *, const double *in, size_t n_in, double *out, size_t n_out);
  /* The same for `count` calls in their order, in: count x n_in, out: count x n_out, in a sixth less time
   * than as many single ones take. After one that fails none is made. */
  hk_status (*call_each)(const hk_host *, const hk_function *, const double *in, size_t n_in, double *out, size_t n_out,
                         size_t count);
};

#endif
