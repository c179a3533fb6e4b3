/* What a front begins with and what its children add to it; included by dense_loops.h for each width. */

TARGET static void NAME(begin)(const hk_supernodes *s, const hk_supernode *n, const double *value, void *panel) {
  size_t b = s->block;
  memset(panel, 0, n->ld * b * n->columns * sizeof(HK_REAL));
  for (const hk_entry *e = s->entry + n->entry; e < s->entry + n->entry_end; e++) {
    const double *from = value + b * b * e->block;
    HK_REAL *to = (HK_REAL *)panel + e->to;
    for (size_t c = 0; c < b; c++)
      for (size_t r = 0; r < b; r++) to[n->ld * c + r] = (HK_REAL)from[b * c + r];
  }
}

/* Adds the columns of a run, and those of the runs after it as rows. `to` points to the front's first row in the column
 * where the run begins. */
TARGET HK_INLINE void NAME(extend_run)(const hk_row_run *run, const hk_row_run *end, size_t b, const HK_REAL *from,
                                       size_t ld, HK_REAL *to, size_t ld_to) {
  for (size_t c = 0; c < b * run->count; c++) {
    const HK_REAL *source = from + ld * (b * run->from + c);
    HK_REAL *target = to + ld_to * c;
    for (const hk_row_run *rows = run; rows < end; rows++) {
      const HK_REAL *add = source + b * rows->from;
      HK_REAL *sum = target + b * rows->to;
      for (size_t r = rows == run ? c : 0; r < b * rows->count; r++) sum[r] += add[r];
    }
  }
}

TARGET static void NAME(extend_panel)(const hk_supernodes *s, const hk_supernode *child, const void *from,
                                      const hk_supernode *n, void *panel) {
  const hk_row_run *end = s->run + child->run_end, *run = s->run + child->run;
  for (; run < end && run->to < n->columns; run++) NAME(extend_run)
  (run, end, s->block, from, child->ldu, (HK_REAL *)panel + n->ld * s->block * run->to + n->top, n->ld);
}

TARGET static void NAME(extend_update)(const hk_supernodes *s, const hk_supernode *child, const void *from,
                                       const hk_supernode *n, void *update) {
  const hk_row_run *end = s->run + child->run_end, *run = s->run + child->run;
  size_t inner = s->block * n->columns;
  while (run < end && run->to < n->columns) run++;
  for (; run < end; run++) {
    size_t column = s->block * run->to - inner;
    NAME(extend_run)(run, end, s->block, from, child->ldu, (HK_REAL *)update + n->ldu * column - inner, n->ldu);
  }
}
