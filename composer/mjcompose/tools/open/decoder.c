// MuJoCo opens recipes in programs without Python: a decoder that runs mjcompose and parses the MJCF that it prints.
//
// `mjcompose plugin install` compiles it into MuJoCo's plugin folder. It is linked to no libmujoco, because a library of
// one version in the folder of another would break the program: it finds the one that the program has loaded.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <link.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <mujoco/mujoco.h>

#ifndef MJCOMPOSE_PYTHON
#error "MJCOMPOSE_PYTHON is the Python that runs mjcompose"
#endif

// The most seconds that mjcompose may take, which MJCOMPOSE_OPEN_SECONDS changes, and the largest model that it may print.
static const double kSeconds = 600;
static const size_t kMost = (size_t)256 << 20;

extern char** environ;
static mjSpec* (*parse)(const char* text, const mjVFS* vfs, char* error, int size);

// Writes the first line of a reason into a buffer of MuJoCo, shortened by whole characters of UTF-8.
static void explain(char* error, int size, const char* reason) {
  if (!error || size < 1) return;
  size_t length = strcspn(reason, "\r\n");
  if (length > (size_t)size - 1) {
    length = size - 1;
    while (length && ((unsigned char)reason[length] & 0xC0) == 0x80) length--;
  }
  memcpy(error, reason, length);
  error[length] = 0;
}

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec + time.tv_nsec * 1e-9;
}

static double seconds_allowed(void) {
  const char* chosen = getenv("MJCOMPOSE_OPEN_SECONDS");
  double seconds = chosen ? strtod(chosen, NULL) : 0;
  return seconds > 0 ? seconds : kSeconds;
}

// Returns the milliseconds until a moment, at most a minute at once; 0 if it has passed.
static int left_until(double end) {
  double left = (end - now()) * 1000;
  return left <= 0 ? 0 : left < 60000 ? (int)left + 1 : 60000;
}

// The output of a program, as text to free, and why it is not whole; without a text there was no memory.
typedef struct {
  char* text;
  int is_late, is_long;
} Output;

static Output read_all(int file, double end) {
  size_t length = 0, room = 1 << 16;
  Output output = {malloc(room), 0, 0};
  struct pollfd ready = {file, POLLIN, 0};
  while (output.text) {
    int wait = left_until(end), events = poll(&ready, 1, wait);
    if (events < 0 && errno == EINTR) continue;
    if (events == 0 && wait > 0) continue;
    if (events <= 0) {
      output.is_late = 1;
      break;
    }
    ssize_t count = read(file, output.text + length, room - length - 1);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    length += count;
    if (length > kMost) {
      output.is_long = 1;
      break;
    }
    if (room - length < 2) {
      char* larger = realloc(output.text, room *= 2);
      if (!larger) free(output.text);
      output.text = larger;
    }
  }
  if (output.text) output.text[length] = 0;
  return output;
}

// Waits for a program until a moment and then kills it. Returns whether it ended by itself, with success.
static int ended_well(pid_t child, double end) {
  int status = 0, is_killed = 0;
  for (;;) {
    pid_t ended = waitpid(child, &status, is_killed ? 0 : WNOHANG);
    if (ended == child) return !is_killed && WIFEXITED(status) && !WEXITSTATUS(status);
    // A program that ignores SIGCHLD has no status of its children: the text decides.
    if (ended < 0 && errno != EINTR) return !is_killed;
    if (ended == 0 && left_until(end) == 0) {
      kill(child, SIGKILL);
      is_killed = 1;
    } else if (ended == 0) {
      poll(NULL, 0, 1);
    }
  }
}

static int can_decode(const mjResource* resource) {
  return 1;
}

static mjSpec* decode(mjResource* resource, const mjVFS* vfs, char* error, int size) {
  const char* chosen = getenv("MJCOMPOSE_PYTHON");
  const char* python = chosen && *chosen ? chosen : MJCOMPOSE_PYTHON;
  // Python must find nothing in the folder of the program, which can have a `yaml.py` of anybody: -P for the module, and
  // another current folder for empty entries of PYTHONPATH and PATH. The child returns to the folder once it runs.
  char folder[PATH_MAX];
  if (!getcwd(folder, sizeof folder)) strcpy(folder, "/");
  char* arguments[] = {(char*)python, "-P", "-m", "mjcompose.tools.open.recipe", resource->name, folder, NULL};
  double seconds = seconds_allowed(), end = now() + seconds;
  int ends[2];
  pid_t child;
  if (pipe2(ends, O_CLOEXEC)) {
    explain(error, size, strerror(errno));
    return NULL;
  }
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, ends[1], 1);
  posix_spawn_file_actions_addchdir_np(&files, "/");
  int failed = posix_spawnp(&child, python, &files, NULL, arguments, environ);
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  if (failed) {
    char reason[512];
    snprintf(reason, sizeof reason, "cannot start `%s`: %s; set MJCOMPOSE_PYTHON to a Python that has mjcompose", python,
             strerror(failed));
    explain(error, size, reason);
    close(ends[0]);
    return NULL;
  }
  Output output = read_all(ends[0], end);
  close(ends[0]);
  int is_cut = !output.text || output.is_late || output.is_long;
  int is_good = ended_well(child, is_cut ? 0 : end);
  int is_late = output.is_late || (!is_good && left_until(end) == 0);
  mjSpec* spec = NULL;
  if (is_late) {
    char reason[256];
    snprintf(reason, sizeof reason, "mjcompose needs more than %g s; MJCOMPOSE_OPEN_SECONDS allows more", seconds);
    explain(error, size, reason);
  } else if (output.is_long) {
    explain(error, size, "mjcompose prints more than 256 MiB; `mjcompose build` writes the model to a bundle");
  } else if (!output.text) {
    explain(error, size, "there is not enough memory for the model");
  } else if (!*output.text) {
    explain(error, size, "mjcompose has stopped without an answer");
  } else if (is_good && *output.text == '<') {
    spec = parse(output.text, vfs, error, size);
  } else {
    explain(error, size, output.text);
  }
  free(output.text);
  return spec;
}

// Finds the MuJoCo that the program has loaded, whose file name depends on its version.
static int find_mujoco(struct dl_phdr_info* info, size_t size, void* found) {
  if (!strstr(info->dlpi_name, "libmujoco")) return 0;
  *(void**)found = dlopen(info->dlpi_name, RTLD_NOW | RTLD_NOLOAD);
  return *(void**)found != NULL;
}

mjPLUGIN_LIB_INIT(mjcompose_decoder) {
  void* mujoco = NULL;
  dl_iterate_phdr(find_mujoco, &mujoco);
  if (!mujoco) return;
  int (*version)(void) = dlsym(mujoco, "mj_version");
  const mjpDecoder* (*find)(const mjResource*, const char*) = dlsym(mujoco, "mjp_findDecoder");
  void (*add)(const mjpDecoder*) = dlsym(mujoco, "mjp_registerDecoder");
  parse = dlsym(mujoco, "mj_parseXMLString");
  mjResource probe;
  memset(&probe, 0, sizeof probe);
  probe.name = "x.yaml";
  // Decoders before 4.0 have other arguments, and a second decoder of an extension would end the process.
  if (!version || version() < 4000000 || !find || !add || !parse || find(&probe, "")) return;
  mjpDecoder decoder;
  memset(&decoder, 0, sizeof decoder);
  decoder.content_type = "application/x-mjcompose";
  decoder.extension = ".yaml|.yml";
  decoder.can_decode = can_decode;
  decoder.decode = decode;
  add(&decoder);
}
