/* One cloth in two processes, by libhooke and the corrector `halo` (tests/fixtures/halo.c): each has the forces on its
 * own half of the rows, with the numbers of all particles, and after each step takes two rows of the other, as far as
 * springs reach. Both halves have the bits of the cloth in one process; printed are bytes and processor time a step.
 * usage: two_processes HALO.so N STEPS */
#define _GNU_SOURCE
#include <hooke.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* `part` 1 and 2 are the lower and the upper half, 0 is all. An edge belongs to each part that has one of its ends.
 * Rest lengths are given, since initial lengths that differ by rounding alone become one number of all springs of a
 * list, which halves do not know. */
static const char scene[] =
    "local N = param('N', 64, 'particles along one side', { min = 4 })\n"
    "local part = param('part', 0, 'of the cloth', { min = 0, max = 2 })\n"
    "local socket = param('socket', 0, 'to the other process')\n"
    "local halo = param('halo', '', 'the plugin')\n"
    "local steps = param('steps', 100, 'of 1e-4 s')\n"
    "local scene = hooke.scene { duration = steps * 1e-4, fps = 1e4 / steps, dt = 1e-4, integrator = "
    "'symplectic_euler' }\n"
    "local cut = N // 2\n"
    "scene:grid { nx = N, ny = N, width = 1, height = 1, mass = 0.2 }\n"
    "scene:pin { 1, N }\n"
    "local function mine(row) return part == 0 or (row <= cut) == (part == 1) end\n"
    "local function edges(list)\n"
    "  local found = {}\n"
    "  for _, d in ipairs(list) do\n"
    "    for row = 1, N do\n"
    "      for column = 1, N do\n"
    "        local r, c = row + d[2], column + d[1]\n"
    "        if r <= N and c >= 1 and c <= N and (mine(row) or mine(r)) then\n"
    "          found[#found + 1] = { (row - 1) * N + column, (r - 1) * N + c }\n"
    "        end\n"
    "      end\n"
    "    end\n"
    "  end\n"
    "  return found\n"
    "end\n"
    "scene:force('gravity', {})\n"
    "scene:force('springs', { edges = edges { { 1, 0 }, { 0, 1 } }, k = 400, damping = 0.02, rest = 1 / (N - 1), label "
    "= 'structural' })\n"
    "scene:force('springs', { edges = edges { { 1, 1 }, { -1, 1 } }, k = 200, damping = 0.02, rest = 2 ^ 0.5 / (N - "
    "1), label = 'shear' })\n"
    "scene:force('springs', { edges = edges { { 2, 0 }, { 0, 2 } }, k = 20, damping = 0.02, rest = 2 / (N - 1), label "
    "= 'bend' })\n"
    "local below, above = (cut - 2) * N, cut * N\n"
    "if part > 0 then\n"
    "  scene:corrector(halo, { socket = socket, count = 2 * N, mine = part == 1 and below or above,\n"
    "    theirs = part == 1 and above or below, first = part == 1 and 1 or 0 })\n"
    "end\n"
    "return scene\n";

typedef struct shared { /* what a process tells of its run, in memory of all */
  int fine;
  double seconds, exchange; /* of the processor in the last two thirds of the steps, and in their exchanges */
  double bytes;             /* that were sent */
  long resident;            /* kB, at most */
  double state[];           /* 2 x n x 3: m, m/s */
} shared;

static double processor_time(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double figure(const char *summary, const char *name) {
  const char *at = summary ? strstr(summary, name) : NULL;
  at = at ? strpbrk(at + strlen(name), "-0123456789") : NULL;
  return at ? strtod(at, NULL) : 0;
}

static int set(hooke_run *run, const char *name, long value) {
  char text[32];
  snprintf(text, sizeof text, "%ld", value);
  return hooke_parameter(run, name, text) == HOOKE_OK;
}

static void run_part(shared *out, const char *plugin, long n, long steps, int part, int socket) {
  hooke_run *run = hooke_new();
  if (!set(run, "N", n) || !set(run, "steps", steps) || !set(run, "part", part) || !set(run, "socket", socket) ||
      hooke_parameter(run, "halo", plugin) != HOOKE_OK || hooke_option(run, "trust", NULL) != HOOKE_OK ||
      hooke_option(run, "threads", "1") != HOOKE_OK || hooke_open_text(run, "cloth.lua", scene) != HOOKE_OK) {
    fprintf(stderr, "part %d: %s\n", part, hooke_error(run));
    exit(1);
  }
  double from[2], to[2]; /* of a third of the steps and of all, what is done once being in the first */
  hooke_status status = hooke_advance(run, (double)(steps / 3) * 1e-4);
  from[0] = processor_time(), from[1] = figure(hooke_summary(run), "\"exchange\"");
  if (status == HOOKE_OK) status = hooke_advance(run, hooke_end(run));
  to[0] = processor_time(), to[1] = figure(hooke_summary(run), "\"exchange\"");
  if (status != HOOKE_OK) {
    fprintf(stderr, "part %d: %s\n", part, hooke_error(run));
    exit(1);
  }
  out->seconds = to[0] - from[0], out->exchange = to[1] - from[1];
  out->bytes = figure(hooke_summary(run), "sent_bytes");
  size_t numbers = 3 * (size_t)(n * n), first = part == 2 ? (size_t)(n / 2 * n) * 3 : 0;
  size_t end = part == 1 ? (size_t)(n / 2 * n) * 3 : numbers;
  memcpy(out->state + first, hooke_positions(run) + first, (end - first) * sizeof(double));
  memcpy(out->state + numbers + first, hooke_velocities(run) + first, (end - first) * sizeof(double));
  struct rusage used;
  getrusage(RUSAGE_SELF, &used);
  out->resident = used.ru_maxrss;
  out->fine = 1;
  hooke_free(run);
  exit(0);
}

int main(int count, char **argument) {
  if (count != 4) return 2;
  long n = atol(argument[2]), steps = atol(argument[3]);
  size_t numbers = 6 * (size_t)(n * n), size = sizeof(shared) + numbers * sizeof(double);
  shared *out[3];
  int pair[2];
  if (n < 4 || steps < 3 || socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0) return 2;
  for (int part = 0; part < 3; part++) {
    out[part] = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (out[part] == MAP_FAILED) return 2;
  }
  for (int part = 0; part < 3; part++) {
    pid_t process = fork();
    if (process < 0) return 2;
    if (process == 0) {
      close(pair[part == 1]);
      run_part(out[part], argument[1], n, steps, part, pair[part != 1]);
    }
    if (part == 0) waitpid(process, NULL, 0);
  }
  close(pair[0]), close(pair[1]);
  while (wait(NULL) > 0) continue;
  if (!out[0]->fine || !out[1]->fine || !out[2]->fine) return 1;
  size_t half = (size_t)(n / 2 * n) * 3, other = 0;
  for (size_t k = 0; k < numbers; k++) {
    const double *of = out[k % (numbers / 2) < half ? 1 : 2]->state;
    other += memcmp(of + k, out[0]->state + k, sizeof(double)) != 0;
  }
  double measured = (double)(steps - steps / 3);
  printf("%ld x %ld particles, %ld steps, of the processor: alone %.1f us a step, %ld MB\n", n, n, steps,
         1e6 * out[0]->seconds / measured, out[0]->resident / 1024);
  for (int part = 1; part < 3; part++)
    printf("half %d: %.1f us a step, of them %.1f in exchanging; %.0f bytes sent a step; %ld MB\n", part,
           1e6 * out[part]->seconds / measured, 1e6 * out[part]->exchange / measured, out[part]->bytes / (double)steps,
           out[part]->resident / 1024);
  if (other)
    printf("%zu of %zu numbers have other bits\n", other, numbers);
  else
    printf("the same bits\n");
  return other > 0;
}
