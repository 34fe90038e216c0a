// A file system without locks, as NFS and Lustre may be: every call for one fails with ENOLCK.
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <unistd.h>

int flock(int file, int operation) {
  (void)file, (void)operation;
  errno = ENOLCK;
  return -1;
}

int fcntl(int file, int command, ...) {
  va_list arguments;
  va_start(arguments, command);
  const long argument = va_arg(arguments, long);
  va_end(arguments);
  switch (command) {
    case F_SETLK:
    case F_SETLKW:
    case F_OFD_SETLK:
    case F_OFD_SETLKW:
      errno = ENOLCK;
      return -1;
    default:
      return (int)syscall(SYS_fcntl, file, command, argument);
  }
}

int fcntl64(int file, int command, ...) __attribute__((alias("fcntl")));
