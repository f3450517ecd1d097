/* What the sources declare by POSIX headers and WASI's lack; none of it can be called from the page (wasi.c). */
#ifndef WEB_WASI_H
#define WEB_WASI_H

#ifdef __cplusplus
extern "C" {
#endif
int dup(int descriptor);
#ifdef __cplusplus
}
#endif

#endif
