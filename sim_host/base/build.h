/* Version and commit of this program, written by the build. */
#ifndef SIM_HOST_BASE_BUILD_H
#define SIM_HOST_BASE_BUILD_H

/* That of include/iqfoc/version.h. */
extern const char build_version[];
/* Ten digits, and a + where the tree had changes; empty where it was no git tree. */
extern const char build_commit[];

#endif
