/* Minizip over an output file that is already open (fmu_archive.h). */
#include "fmu_archive.h"

#include <errno.h>
#include <limits.h>
#include <string.h>
#include <zip.h>

/* Minizip's view of a file: `opaque` is the stream, which stays open behind it. */
static voidpf stream_open(voidpf opaque, const void *name, int mode)
{
    (void)name, (void)mode;
    return opaque;
}

static uLong stream_read(voidpf opaque, voidpf stream, void *bytes, uLong size)
{
    (void)opaque;
    return (uLong)fread(bytes, 1, size, stream);
}

static uLong stream_write(voidpf opaque, voidpf stream, const void *bytes, uLong size)
{
    (void)opaque;
    return (uLong)fwrite(bytes, 1, size, stream);
}

static ZPOS64_T stream_tell(voidpf opaque, voidpf stream)
{
    (void)opaque;
    return (ZPOS64_T)ftell(stream);
}

static long stream_seek(voidpf opaque, voidpf stream, ZPOS64_T offset, int origin)
{
    (void)opaque;
    const int whence = origin == ZLIB_FILEFUNC_SEEK_END   ? SEEK_END
                       : origin == ZLIB_FILEFUNC_SEEK_CUR ? SEEK_CUR
                                                          : SEEK_SET;
    return fseek(stream, (long)offset, whence);
}

static int stream_close(voidpf opaque, voidpf stream)
{
    (void)opaque, (void)stream;
    return 0;
}

static int stream_error(voidpf opaque, voidpf stream)
{
    (void)opaque;
    return ferror((FILE *)stream);
}

bool fmu_archive_open(fmu_archive *a, const char *path, error *e)
{
    memset(a, 0, sizeof *a);
    if (!out_file_open(&a->file, path, e)) {
        return false;
    }
    if (fseek(a->file.stream, 0, SEEK_SET) != 0) {
        out_file_abandon(&a->file);
        return error_input(e, path, 0, 0,
                           "expected a file that can be written out of order, as an archive is");
    }
    zlib_filefunc64_def calls = {.zopen64_file = stream_open,
                                 .zread_file = stream_read,
                                 .zwrite_file = stream_write,
                                 .ztell64_file = stream_tell,
                                 .zseek64_file = stream_seek,
                                 .zclose_file = stream_close,
                                 .zerror_file = stream_error,
                                 .opaque = a->file.stream};
    a->zip = zipOpen2_64(path, APPEND_STATUS_CREATE, NULL, &calls);
    if (a->zip == NULL) {
        out_file_abandon(&a->file);
        return error_failure(e, ENOMEM, "%s: the archive cannot be begun", path);
    }
    return true;
}

bool fmu_archive_add(fmu_archive *a, const char *name, const void *bytes, size_t length, error *e)
{
    /* The first day that ZIP knows, so that the same input makes the same archive. */
    const zip_fileinfo about = {.tmz_date = {.tm_mday = 1, .tm_year = 1980}};
    errno = 0;
    const bool good = length <= UINT_MAX &&
                      zipOpenNewFileInZip(a->zip, name, &about, NULL, 0, NULL, 0, NULL, Z_DEFLATED,
                                          Z_DEFAULT_COMPRESSION) == ZIP_OK &&
                      zipWriteInFileInZip(a->zip, bytes, (unsigned)length) == ZIP_OK &&
                      zipCloseFileInZip(a->zip) == ZIP_OK;
    return good || error_failure(e, errno, "%s: cannot be written into the archive", name);
}

bool fmu_archive_close(fmu_archive *a, bool ok, error *e)
{
    if (a->zip == NULL) {
        return false;
    }
    errno = 0;
    const bool closed = zipClose(a->zip, NULL) == ZIP_OK;
    a->zip = NULL;
    if (ok && !closed) {
        error_failure(e, errno, "the archive cannot be finished");
    }
    if (!ok || !closed) {
        out_file_abandon(&a->file);
        return false;
    }
    return out_file_commit(&a->file, e);
}
