/* The kernel's filter of system calls (confine.h), written by hand: it is a list of numbers, and no library is needed for that. */
#define _GNU_SOURCE /* CLONE_THREAD */

#include "confine.h"

#if defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__))

#include <errno.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#if defined(__x86_64__)
#define OWN_ARCH    AUDIT_ARCH_X86_64
#define FOREIGN_ABI UINT32_C(0x40000000) /* from here on: x32's numbers of the same calls */
#else
#define OWN_ARCH    AUDIT_ARCH_AARCH64
#define FOREIGN_ABI UINT32_MAX
#endif

/* The address sanitizer looks for leaks from a second process, and has a program name the places in its reports. */
#if defined(__SANITIZE_ADDRESS__)
#define WATCHED_BY_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define WATCHED_BY_SANITIZER 1
#endif
#endif

static const uint32_t never[] = {
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_kcmp,
    SYS_pidfd_getfd,
    SYS_bpf,
    SYS_perf_event_open,
    SYS_userfaultfd,
    SYS_add_key,
    SYS_request_key,
    SYS_keyctl,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_reboot,
    SYS_swapon,
    SYS_swapoff,
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_open_tree,
    SYS_move_mount,
    SYS_fsopen,
    SYS_fspick,
    SYS_unshare,
    SYS_setns,
    SYS_open_by_handle_at,
    SYS_io_uring_setup, /* would do most of the others unseen */
};

/* Beginning something, getting hold of what runs, or being another user: gnuplot makes sure that it is the one who called it, and
 * ends where it may not. */
static const uint32_t starting[] = {
    SYS_ptrace, SYS_kill,   SYS_rt_sigqueueinfo, SYS_pidfd_send_signal, SYS_execve,    SYS_execveat,
    SYS_setuid, SYS_setgid, SYS_setresuid,       SYS_setresgid,         SYS_setgroups,
#ifdef SYS_fork
    SYS_fork,   SYS_vfork,
#endif
};

static const uint32_t connecting[] = {
    SYS_socket, SYS_socketpair, SYS_connect, SYS_bind, SYS_listen, SYS_accept, SYS_accept4,
};

enum {
    NEVER = sizeof never / sizeof never[0],
    STARTING = sizeof starting / sizeof starting[0],
    CONNECTING = sizeof connecting / sizeof connecting[0],
    PROGRAM_MOST = 2 * (NEVER + STARTING + CONNECTING) + 16,
};

typedef struct program {
    struct sock_filter code[PROGRAM_MOST];
    unsigned short length;
} program;

static void put(program *p, uint16_t code, uint8_t if_true, uint8_t if_false, uint32_t value)
{
    p->code[p->length++] = (struct sock_filter){code, if_true, if_false, value};
}

static void put_load(program *p, size_t offset)
{
    put(p, BPF_LD | BPF_W | BPF_ABS, 0, 0, (uint32_t)offset);
}

/* If the comparison of what was loaded with `number` holds: this answer. */
static void put_case(program *p, uint16_t comparison, uint32_t number, uint32_t answer)
{
    put(p, BPF_JMP | comparison | BPF_K, 0, 1, number);
    put(p, BPF_RET | BPF_K, 0, 0, answer);
}

static void put_refusals(program *p, const uint32_t *numbers, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        put_case(p, BPF_JEQ, numbers[k], SECCOMP_RET_ERRNO | EPERM);
    }
}

/* Threads are begun by the same call as processes; its newer form hides which, and the C library does without where it is missing. */
static void put_threads_only(program *p)
{
    put_case(p, BPF_JEQ, SYS_clone3, SECCOMP_RET_ERRNO | ENOSYS);
    put(p, BPF_JMP | BPF_JEQ | BPF_K, 0, 3, SYS_clone);
    put_load(p, offsetof(struct seccomp_data, args[0])); /* the low half: both processors are little-endian */
    put(p, BPF_JMP | BPF_JSET | BPF_K, 1, 0, CLONE_THREAD);
    put(p, BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ERRNO | EPERM);
}

void confine(unsigned needed)
{
#ifdef WATCHED_BY_SANITIZER
    needed |= CONFINE_MAY_START;
#endif
    program p = {.length = 0};
    put_load(&p, offsetof(struct seccomp_data, arch));
    put(&p, BPF_JMP | BPF_JEQ | BPF_K, 1, 0, OWN_ARCH);
    put(&p, BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ERRNO | EPERM);
    put_load(&p, offsetof(struct seccomp_data, nr));
    put_case(&p, BPF_JGE, FOREIGN_ABI, SECCOMP_RET_ERRNO | EPERM);
    put_refusals(&p, never, NEVER);
    if (!(needed & CONFINE_MAY_CONNECT)) {
        put_refusals(&p, connecting, CONNECTING);
    }
    if (!(needed & CONFINE_MAY_START)) {
        put_refusals(&p, starting, STARTING);
        put_threads_only(&p);
    }
    put(&p, BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ALLOW);

    const struct sock_fprog whole = {p.length, p.code};
    /* Where either is refused we are as we were. */
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) {
        (void)prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &whole);
    }
}

#else

void confine(unsigned needed)
{
    (void)needed;
}

#endif
