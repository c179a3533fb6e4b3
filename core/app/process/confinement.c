/* Two doors of Linux, used through their system calls. Landlock (Linux 5.13) allows files and folders one by one;
 * seccomp (Linux 3.5) refuses system calls with EPERM, by a filter over their numbers. Programs are started by
 * posix_spawn in an output (ffmpeg): where landlock allows that one program, execve stays; what it runs is as confined
 * as this process. Without landlock nothing is executed. The filter names what is refused, not what is allowed:
 * libraries of linear algebra and graphics call what they like, and none of it needs the network or other processes. */
#define _GNU_SOURCE /* dl_iterate_phdr, O_PATH */
#include "core/app/process/process.h"

#include <errno.h>
#include <limits.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The folders made for the output, outermost first: ends of prefixes of `path`. */
static struct made {
  char path[PATH_MAX];
  size_t count, end[32];
} made;

void hk_confinement_end(void) {
  while (made.count > 0) {
    made.path[made.end[--made.count]] = 0;
    if (rmdir(made.path) != 0) return;
  }
}

#if defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#endif

#if defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__)) && !defined(SANITIZED)

#include <fcntl.h>
#include <link.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#ifndef LANDLOCK_ACCESS_FS_REFER
#define LANDLOCK_ACCESS_FS_REFER (1ULL << 13)
#endif
#ifndef LANDLOCK_ACCESS_FS_TRUNCATE
#define LANDLOCK_ACCESS_FS_TRUNCATE (1ULL << 14) /* Linux 6.2; headers of Debian 12 lack it */
#endif

enum {
  RUN = LANDLOCK_ACCESS_FS_EXECUTE,
  SEE = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR,
  CHANGE = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_TRUNCATE,
  MAKE = LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_REMOVE_FILE,
  FOLDERS = LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_REMOVE_DIR,
  OF_FILES = RUN | LANDLOCK_ACCESS_FS_READ_FILE | CHANGE, /* what a rule for a file may name */
  OTHERS = LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
           LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM
};

/* ---- landlock: files, and signals, which then reach none but processes that this one starts ---- */

/* struct landlock_ruleset_attr of version 6 (Linux 6.12); headers of Debian 12 have the first member alone. Before,
 * what ends cases that take too long has to stay allowed, and with it signals to the user's other processes. */
typedef struct attributes {
  uint64_t files, network, scoped;
} attributes;

enum { SIGNALS_SINCE = 6, SCOPE_SIGNAL = 1 << 1 };

typedef struct ruleset {
  int descriptor;
  uint64_t handled;
} ruleset;

/* What is not there is not allowed. */
static void allow(const ruleset *rules, const char *path, uint64_t access) {
  struct stat info;
  int file = path && *path ? open(path, O_PATH | O_CLOEXEC) : -1;
  if (file < 0) return;
  if (fstat(file, &info) == 0 && !S_ISDIR(info.st_mode)) access &= OF_FILES;
  struct landlock_path_beneath_attr rule = {.allowed_access = access & rules->handled, .parent_fd = file};
  syscall(SYS_landlock_add_rule, rules->descriptor, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
  close(file);
}

static void allow_folder_of(const ruleset *rules, const char *path, uint64_t access) {
  char folder[PATH_MAX];
  const char *slash = strrchr(path, '/');
  snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
  allow(rules, folder, access);
}

/* Calls allow() for the folders of a list such as PATH; `name`: a file in them, NULL: themselves. */
static void allow_list(const ruleset *rules, const char *list, const char *name, uint64_t access) {
  char path[PATH_MAX];
  for (const char *part = list; part && *part; part += *part == ':') {
    size_t length = strcspn(part, ":");
    if (length && snprintf(path, sizeof path, "%.*s/%s", (int)length, part, name ? name : "") < (int)sizeof path)
      allow(rules, path, access);
    part += length;
  }
}

/* The folders of the libraries that are there already, where others lie, too; of them the program interpreter, which
 * every program is started by, may be executed. */
static int allow_library(struct dl_phdr_info *library, size_t size, void *rules) {
  (void)size;
  const char *name = strrchr(library->dlpi_name, '/');
  if (name && library->dlpi_name[0] == '/' && name > library->dlpi_name)
    allow_folder_of(rules, library->dlpi_name, SEE);
  if (name && strncmp(name, "/ld", 3) == 0) allow(rules, library->dlpi_name, RUN | SEE);
  return 0;
}

/* What programs, libraries and drivers read. */
static void allow_system(const ruleset *rules) {
  static const char *const seen[] = {"/usr",        "/lib",           "/lib32",         "/lib64",
                                     "/opt",        "/nix/store",     "/gnu/store",     "/sys/devices",
                                     "/sys/dev",    "/sys/class/drm", "/proc/cpuinfo",  "/proc/meminfo",
                                     "/proc/stat",  "/proc/self",     "/proc/sys/vm",   "/etc/ld.so.cache",
                                     "/etc/glvnd",  "/etc/drirc",     "/etc/localtime", "/etc/alternatives",
                                     "/dev/urandom"};
  static const char *const used[] = {"/dev/null", "/dev/zero", "/dev/dri"};
  for (size_t k = 0; k < sizeof seen / sizeof *seen; k++) allow(rules, seen[k], SEE);
  for (size_t k = 0; k < sizeof used / sizeof *used; k++) allow(rules, used[k], SEE | CHANGE);
  dl_iterate_phdr(allow_library, (void *)(uintptr_t)rules);
}

static void allow_writing(const ruleset *rules, const hk_confinement *c) {
  char outermost[PATH_MAX];
  if (c->output) allow(rules, c->output, SEE | CHANGE | MAKE | FOLDERS);
  if (c->cache) allow(rules, c->cache, SEE | CHANGE | MAKE);
  for (size_t k = 0; k < sizeof c->written / sizeof *c->written; k++) {
    if (!c->written[k]) continue;
    allow_folder_of(rules, c->written[k], CHANGE | MAKE);
    allow(rules, c->written[k], CHANGE);
  }
  if (!made.count) return;
  snprintf(outermost, sizeof outermost, "%.*s", (int)made.end[0], made.path);
  allow_folder_of(rules, outermost, LANDLOCK_ACCESS_FS_REMOVE_DIR); /* for hk_confinement_end: of empty folders */
}

static bool close_files(const hk_confinement *c) {
  long version = syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
  if (version < 1) return false;
  ruleset rules = {.handled = RUN | SEE | CHANGE | MAKE | FOLDERS | OTHERS};
  if (version >= 2) rules.handled |= LANDLOCK_ACCESS_FS_REFER;
  if (version < 3) rules.handled &= ~(uint64_t)LANDLOCK_ACCESS_FS_TRUNCATE;
  attributes asked = {.files = rules.handled, .scoped = version >= SIGNALS_SINCE ? SCOPE_SIGNAL : 0};
  size_t size = version >= SIGNALS_SINCE ? sizeof asked : sizeof asked.files;
  rules.descriptor = (int)syscall(SYS_landlock_create_ruleset, &asked, size, 0);
  if (rules.descriptor < 0) return false;
  allow_system(&rules);
  allow_folder_of(&rules, c->scene, SEE);
  allow(&rules, c->scene, SEE);
  for (size_t k = 0; k < sizeof c->read / sizeof *c->read; k++) allow(&rules, c->read[k], SEE);
  allow_list(&rules, c->search, NULL, SEE);
  allow_list(&rules, c->libraries, NULL, SEE);
  allow_list(&rules, c->programs, "ffmpeg", RUN | SEE);
  allow_writing(&rules, c);
  bool closed = syscall(SYS_landlock_restrict_self, rules.descriptor, 0) == 0;
  close(rules.descriptor);
  return closed;
}

/* ---- seccomp: system calls ---- */

#if defined(__x86_64__)
#define ARCHITECTURE AUDIT_ARCH_X86_64
#else
#define ARCHITECTURE AUDIT_ARCH_AARCH64
#endif

#ifndef __NR_pidfd_getfd
#define __NR_pidfd_getfd 438
#endif
#ifndef __NR_process_madvise
#define __NR_process_madvise 440
#endif

static const int refused[] = {
    /* the network; nothing is sent without a socket */
    __NR_socket,
    __NR_connect,
    __NR_bind,
    __NR_listen,
    __NR_accept,
    __NR_accept4,
    /* other processes */
    __NR_ptrace,
    __NR_process_vm_readv,
    __NR_process_vm_writev,
    __NR_kcmp,
    __NR_pidfd_open,
    __NR_pidfd_getfd,
    __NR_pidfd_send_signal,
    __NR_process_madvise,
    __NR_rt_sigqueueinfo,
    __NR_rt_tgsigqueueinfo,

    __NR_shmget,
    __NR_shmat,
    __NR_msgget,
    __NR_semget,
    __NR_mq_open,
    /* calls that are made for others, past this filter */
    __NR_io_uring_setup,
    __NR_io_uring_enter,
    __NR_io_uring_register,
    /* what the system is made of */
    __NR_mount,
    __NR_umount2,
    __NR_pivot_root,
    __NR_chroot,
    __NR_setns,
    __NR_unshare,
    __NR_bpf,
    __NR_perf_event_open,
    __NR_userfaultfd,
    __NR_add_key,
    __NR_request_key,
    __NR_keyctl,
    __NR_init_module,
    __NR_finit_module,
    __NR_delete_module,
    __NR_kexec_load,
    __NR_reboot,
    __NR_swapon,
    __NR_swapoff,
    __NR_acct,
    __NR_quotactl,
    __NR_open_by_handle_at,
    __NR_name_to_handle_at,
    __NR_personality,
    __NR_sethostname,
    __NR_setdomainname,
    __NR_settimeofday,
    __NR_clock_settime,
    __NR_adjtimex,
    __NR_clock_adjtime,
    __NR_syslog,
    __NR_vhangup,
    __NR_fanotify_init,
    __NR_move_mount,
    __NR_open_tree,
    __NR_fsopen,
    __NR_fsmount,
    __NR_fspick,
    __NR_fsconfig,
#if defined(__x86_64__)
    __NR_iopl,
    __NR_ioperm,
    __NR_modify_ldt,
    __NR_uselib,
    __NR_kexec_file_load,
#endif
};

/* Terminal input in the user's name, for the shell to read after us (TIOCLINUX: by the console's selection). */
static const unsigned refused_ioctls[] = {TIOCSTI, TIOCLINUX};

enum { REFUSED = sizeof refused / sizeof *refused, MOST = 2 * REFUSED + 40 };

typedef struct program {
  unsigned short length;
  struct sock_filter code[MOST];
} program;

static void add(program *p, unsigned short code, uint32_t k, uint8_t yes, uint8_t no) {
  p->code[p->length++] = (struct sock_filter){code, yes, no, k};
}

static void load(program *p, size_t offset) { add(p, BPF_LD | BPF_W | BPF_ABS, (uint32_t)offset, 0, 0); }

/* Returns `verdict` where the loaded word equals k. */
static void where_equal(program *p, uint32_t k, uint32_t verdict) {
  add(p, BPF_JMP | BPF_JEQ | BPF_K, k, 0, 1);
  add(p, BPF_RET | BPF_K, verdict, 0, 0);
}

static void write_program(program *p, bool execute) {
  const uint32_t refuse = SECCOMP_RET_ERRNO | EPERM, kill = SECCOMP_RET_KILL_PROCESS;
  enum { WORDS = 3 };
  load(p, offsetof(struct seccomp_data, arch));
  add(p, BPF_JMP | BPF_JEQ | BPF_K, ARCHITECTURE, 1, 0);
  add(p, BPF_RET | BPF_K, kill, 0, 0);
  load(p, offsetof(struct seccomp_data, nr));
#if defined(__x86_64__)
  add(p, BPF_JMP | BPF_JGE | BPF_K, 0x40000000, 0, 1); /* the numbers of x32 are others */
  add(p, BPF_RET | BPF_K, kill, 0, 0);
#endif
  for (size_t k = 0; k < REFUSED; k++) where_equal(p, (uint32_t)refused[k], refuse);
  if (!execute) where_equal(p, __NR_execve, refuse);
  if (!execute) where_equal(p, __NR_execveat, refuse);
  size_t ioctls = sizeof refused_ioctls / sizeof *refused_ioctls;
  add(p, BPF_JMP | BPF_JEQ | BPF_K, __NR_ioctl, 0, (uint8_t)(1 + 2 * ioctls));
  load(p, offsetof(struct seccomp_data, args[1])); /* the lower half, which is what ioctl looks at */
  for (size_t k = 0; k < ioctls; k++) where_equal(p, refused_ioctls[k], refuse);
  add(p, BPF_RET | BPF_K, SECCOMP_RET_ALLOW, 0, 0);
}

static bool close_calls(bool execute) {
  program p = {0};
  write_program(&p, execute);
  struct sock_fprog filter = {p.length, p.code};
  return syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &filter) == 0;
}

/* As the run itself would make it later; that it cannot be made is said then. No link is followed to a folder that the
 * user has not named. */
static void make_output(const char *folder, bool named) {
  struct stat info;
  if (snprintf(made.path, sizeof made.path, "%s/", folder) >= (int)sizeof made.path) return;
  for (char *slash = strchr(made.path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
    *slash = 0;
    if (!named && lstat(made.path, &info) == 0 && S_ISLNK(info.st_mode)) return;
    if (mkdir(made.path, 0777) == 0 && made.count < 32) made.end[made.count++] = (size_t)(slash - made.path);
    *slash = '/';
  }
}

/* Private, as the folders of a user's caches are meant to be; where it cannot be made, auto says that nothing is kept.
 */
static void make_cache(const char *folder) {
  char path[PATH_MAX];
  if (snprintf(path, sizeof path, "%s/", folder) >= (int)sizeof path) return;
  for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
    *slash = 0;
    mkdir(path, 0700);
    *slash = '/';
  }
}

const char *hk_confine(const hk_confinement *c) {
  if (c->output) make_output(c->output, c->named);
  if (c->cache) make_cache(c->cache);
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return "this process is not confined: this kernel is too old";
  bool files = close_files(c), calls = close_calls(files);
  if (files && calls) return NULL;
  if (calls)
    return "this kernel has no landlock: this process has given up programs (so no video is made) and the "
           "network, "
           "but not the files that its user may read and write";
  if (files) return "this kernel has no seccomp filters: this process has not given up the network";
  return "this kernel has neither landlock nor seccomp filters: this process has given up nothing";
}

#else

const char *hk_confine(const hk_confinement *c) {
  (void)c;
#ifdef SANITIZED
  return NULL; /* the sanitizers need what would be given up; nobody runs foreign scenes in such a build */
#else
  return "this process has given up nothing: hooke knows how on Linux, on x86-64 and arm64";
#endif
}

#endif
