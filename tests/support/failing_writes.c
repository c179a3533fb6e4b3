/* The calls are answered one by one: CONTINUE lets the kernel do them; an error number is what the caller gets. The
 * child shares its table of files with this process until it calls exec, so the filter's file is here as well. */
#define _GNU_SOURCE
#include "tests/support/failing_writes.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sched.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

/* Where a call names its file: by a number, or by a path after the number of a folder. */
typedef struct call {
  int number;
  const char *name;
  bool path;
} call;

static const call calls[] = {
    {SYS_openat, "open", true},          {SYS_write, "write", false},        {SYS_pwrite64, "pwrite", false},
    {SYS_writev, "writev", false},       {SYS_ftruncate, "truncate", false}, {SYS_fsync, "fsync", false},
    {SYS_fdatasync, "fdatasync", false}, {SYS_close, "close", false},        {SYS_mkdirat, "mkdir", true},
    {SYS_renameat2, "rename", true},
#ifdef SYS_rename
    {SYS_rename, "rename", false}, /* the path is the first argument: not looked at */
    {SYS_mkdir, "mkdir", false},
#endif
#ifdef SYS_renameat
    {SYS_renameat, "rename", true},
#endif
};

enum { CALLS = sizeof calls / sizeof *calls };

static int listen_to_calls(void) {
  struct sock_filter filter[CALLS + 3] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr))};
  for (size_t k = 0; k < CALLS; k++)
    filter[k + 1] =
        (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)calls[k].number, (uint8_t)(CALLS - k), 0);
  filter[CALLS + 1] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  filter[CALLS + 2] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF);
  struct sock_fprog program = {CALLS + 3, filter};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return -1;
  return (int)syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &program);
}

static const call *call_of(const struct seccomp_notif *asked) {
  for (size_t k = 0; k < CALLS; k++)
    if (calls[k].number == asked->data.nr) return &calls[k];
  return NULL;
}

static void link_of(char *into, size_t size, pid_t pid, const char *what) {
  char path[64];
  snprintf(path, sizeof path, "/proc/%d/%s", (int)pid, what);
  ssize_t length = readlink(path, into, size - 1);
  into[length > 0 ? length : 0] = 0;
}

/* A text in the memory of the caller. */
static void text_of(char *into, size_t size, pid_t pid, uint64_t address) {
  char path[64];
  snprintf(path, sizeof path, "/proc/%d/mem", (int)pid);
  int memory = open(path, O_RDONLY);
  ssize_t got = memory < 0 ? 0 : pread(memory, into, size - 1, (off_t)address);
  into[got > 0 ? got : 0] = 0;
  if (memory >= 0) close(memory);
}

/* The file that a call is about. */
static void file_of(char *into, size_t size, const call *c, const struct seccomp_notif *asked) {
  pid_t pid = (pid_t)asked->pid;
  char name[512], folder[PATH_MAX], entry[32];
  bool first = c->number != SYS_openat && !c->path && (!strcmp(c->name, "rename") || !strcmp(c->name, "mkdir"));
  int descriptor = first ? AT_FDCWD : (int)asked->data.args[0];
  snprintf(entry, sizeof entry, descriptor == AT_FDCWD ? "cwd" : "fd/%d", descriptor);
  link_of(folder, sizeof folder, pid, entry);
  if (!c->path && !first) {
    snprintf(into, size, "%s", folder);
    return;
  }
  text_of(name, sizeof name, pid, asked->data.args[first ? 0 : 1]);
  snprintf(into, size, *name == '/' ? "%.0s%s" : "%s/%s", folder, name);
}

static bool counts(const char *folder, const call *c, const struct seccomp_notif *asked, char *file, size_t size) {
  if (!c || (c->number == SYS_openat && !(asked->data.args[2] & (O_CREAT | O_WRONLY | O_RDWR)))) return false;
  file_of(file, size, c, asked);
  size_t length = strlen(folder);
  return strncmp(file, folder, length) == 0 && file[length] == '/';
}

typedef struct failing {
  const char *folder;
  long number;
  int cause;
  test_disk *disk;
} failing;

static void answer(int listener, const failing *f) {
  struct seccomp_notif asked = {0};
  char file[PATH_MAX + 512];
  if (ioctl(listener, SECCOMP_IOCTL_NOTIF_RECV, &asked) != 0) return;
  struct seccomp_notif_resp reply = {.id = asked.id, .flags = SECCOMP_USER_NOTIF_FLAG_CONTINUE};
  const call *c = call_of(&asked);
  if (counts(f->folder, c, &asked, file, sizeof file) && ++f->disk->calls == f->number) {
    reply = (struct seccomp_notif_resp){.id = asked.id, .error = -f->cause};
    snprintf(f->disk->where, sizeof f->disk->where, "%s %.400s", c->name, file);
  }
  ioctl(listener, SECCOMP_IOCTL_NOTIF_SEND, &reply); /* it fails where the caller has ended meanwhile */
}

static void child(volatile int *listener, const char *command) {
  *listener = listen_to_calls();
  if (*listener < 0) *listener = -1;
  if (*listener >= 0) execl("/bin/sh", "sh", "-c", command, (char *)NULL);
  _exit(127);
}

/* The command's exit code, as the shell has it; -1: this kernel lacks something. */
static int run(const char *command, const failing *f) {
  volatile int *listener = mmap(NULL, sizeof *listener, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (listener == MAP_FAILED) return -1;
  fflush(NULL);
  pid_t pid = (pid_t)syscall(SYS_clone, CLONE_FILES | SIGCHLD, 0, 0, 0, 0);
  if (pid == 0) child(listener, command);
  while (pid > 0 && *listener == 0 && waitpid(pid, NULL, WNOHANG) == 0) usleep(100);
  int file = *listener, status = 0;
  munmap((void *)(uintptr_t)listener, sizeof *listener);
  if (pid < 0 || file <= 0) return -1;
  for (struct pollfd p = {file, POLLIN, 0}; poll(&p, 1, -1) >= 0 && !(p.revents & POLLHUP);)
    if (p.revents & POLLIN) answer(file, f);
  close(file);
  if (waitpid(pid, &status, 0) != pid) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool test_disk_can_fail(void) {
  test_disk disk = {0};
  failing f = {test_folder(), 0, 0, &disk};
  return run("exit 7", &f) == 7;
}

static void slurp(const char *name, char *into, size_t size) {
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "rb");
  size_t got = file ? fread(into, 1, size - 1, file) : 0;
  into[got] = 0;
  if (file) fclose(file);
}

void test_hooke_on_disk(test_result *r, test_disk *disk, const char *name, long number, int cause,
                        const char *arguments) {
  char folder[1024], command[4096];
  snprintf(folder, sizeof folder, "%s/%s", test_folder(), name);
  mkdir(folder, 0777);
  *disk = (test_disk){0};
  failing f = {folder, number, cause, disk};
  snprintf(command, sizeof command, "exec >%s/.out 2>%s/.err </dev/null; cd %s && exec '%s/hooke' %s", test_folder(),
           test_folder(), folder, HK_BUILD, arguments);
  r->code = run(command, &f);
  slurp(".out", r->out, sizeof r->out);
  slurp(".err", r->err, sizeof r->err);
}
