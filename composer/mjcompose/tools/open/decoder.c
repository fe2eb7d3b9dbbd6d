// MuJoCo opens recipes in programs without Python: a decoder that runs mjcompose and parses the MJCF that it prints.
//
// `mjcompose plugin install` compiles it into MuJoCo's plugin folder. It is linked to no libmujoco, because a library of
// one version in the folder of another would break the program: it finds the one that the program has loaded.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <mujoco/mujoco.h>

#ifndef MJCOMPOSE_PYTHON
#error "MJCOMPOSE_PYTHON is the Python that runs mjcompose"
#endif

extern char** environ;
static mjSpec* (*parse)(const char* text, const mjVFS* vfs, char* error, int size);

// Writes a reason into a buffer of MuJoCo, shortened by whole characters of UTF-8.
static void explain(char* error, int size, const char* reason) {
  if (!error || size < 1) return;
  size_t length = strlen(reason);
  if (length > (size_t)size - 1) {
    length = size - 1;
    while (length && ((unsigned char)reason[length] & 0xC0) == 0x80) length--;
  }
  memcpy(error, reason, length);
  error[length] = 0;
}

// Returns all that can be read until the end, as text to free; NULL without memory.
static char* read_all(int file) {
  size_t length = 0, room = 1 << 16;
  char* text = malloc(room);
  while (text) {
    ssize_t count = read(file, text + length, room - length - 1);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    length += count;
    if (room - length < 2) {
      char* larger = realloc(text, room *= 2);
      if (!larger) free(text);
      text = larger;
    }
  }
  if (text) text[length] = 0;
  return text;
}

static int can_decode(const mjResource* resource) {
  return 1;
}

static mjSpec* decode(mjResource* resource, const mjVFS* vfs, char* error, int size) {
  const char* chosen = getenv("MJCOMPOSE_PYTHON");
  const char* python = chosen && *chosen ? chosen : MJCOMPOSE_PYTHON;
  char* arguments[] = {(char*)python, "-m", "mjcompose.tools.open.recipe", resource->name, NULL};
  int ends[2], status = 0;
  pid_t child;
  if (pipe2(ends, O_CLOEXEC)) {
    explain(error, size, strerror(errno));
    return NULL;
  }
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, ends[1], 1);
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
  char* text = read_all(ends[0]);
  close(ends[0]);
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  mjSpec* spec = NULL;
  if (!text || !*text) {
    explain(error, size, "mjcompose has stopped without an answer");
  } else if (!WIFEXITED(status) || WEXITSTATUS(status)) {
    explain(error, size, text);
  } else {
    spec = parse(text, vfs, error, size);
  }
  free(text);
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
