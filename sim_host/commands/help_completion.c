/* Scripts for bash, zsh and fish (help.h). */
#include "help.h"

#include "data/cause.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

static void add_causes(help_words *words)
{
    for (int k = 0; k < CAUSE_COUNT && words->count < HELP_WORDS_MAX; k++) {
        if (cause_table[k].named && (int)cause_table[k].of == k) {
            words->of[words->count++] = cause_table[k].id;
        }
    }
}

static void add_commands(help_words *words)
{
    for (int n = 0; n < COMMANDS; n++) {
        words->of[words->count++] = command_table[n].about->name;
    }
}

void help_values(const option_spec *spec, help_words *words)
{
    words->count = 0;
    if (spec->argument == NULL) {
        return;
    }
    if (strncmp(spec->argument, "ID", 2) == 0 || strncmp(spec->argument, "id", 2) == 0) {
        add_causes(words);
        return;
    }
    /* Words that stand for themselves are in small letters or figures: cortex-m4|rv32. */
    const bool listed = strchr(spec->argument, '|') != NULL && !isupper((unsigned char)spec->argument[0]);
    (void)snprintf(words->text, sizeof words->text, "%s", listed ? spec->argument : "");
    for (char *word = strtok(words->text, "|"); word != NULL; word = strtok(NULL, "|")) {
        words->of[words->count++] = word;
    }
}

static bool is_folder(const option_spec *spec)
{
    return spec->argument != NULL && strcmp(spec->argument, "DIR") == 0;
}

static void put_words(const help_words *words, const char *between)
{
    for (int n = 0; n < words->count; n++) {
        printf("%s%s", n > 0 ? between : "", words->of[n]);
    }
}

static void put_commands(const char *between)
{
    help_words words = {0};
    add_commands(&words);
    put_words(&words, between);
}

/* ---- bash ---- */

static void bash_values(const command_about *about, const option_spec *spec)
{
    help_words words;
    help_values(spec, &words);
    if (words.count == 0 && !is_folder(spec)) {
        return; /* files, as for all that has no rule */
    }
    printf("    %s:--%s", about->name, spec->name);
    if (spec->letter != 0) {
        printf("|%s:-%c", about->name, spec->letter);
    }
    if (is_folder(spec)) {
        puts(") mapfile -t COMPREPLY < <(compgen -d -- \"$word\"); return ;;");
        return;
    }
    fputs(") words=\"", stdout);
    put_words(&words, " ");
    puts("\" ;;");
}

void help_bash(void)
{
    puts("# bash completion of iqfoc; made by `iqfoc help --completion bash`\n"
         "_iqfoc() {\n"
         "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} "
         "command=${COMP_WORDS[1]} words=\n"
         "    COMPREPLY=()");
    fputs("    local commands=\"", stdout);
    put_commands(" ");
    puts("\"\n"
         "    if ((COMP_CWORD == 1)); then\n"
         "        mapfile -t COMPREPLY < <(compgen -W \"$commands --help --version\" -- \"$word\")\n"
         "        return\n"
         "    fi\n"
         "    case $command:$before in");
    for (int n = 0; n < COMMANDS; n++) {
        for (const option_spec *spec = command_table[n].about->specs; spec->name != NULL; spec++) {
            bash_values(command_table[n].about, spec);
        }
    }
    puts("    esac\n"
         "    if [[ -z $words && $word == -* ]]; then\n"
         "        case $command in");
    for (int n = 0; n < COMMANDS; n++) {
        printf("        %s) words=\"", command_table[n].about->name);
        for (const option_spec *spec = command_table[n].about->specs; spec->name != NULL; spec++) {
            printf("--%s ", spec->name);
        }
        puts("--help\" ;;");
    }
    puts("        esac\n"
         "    fi\n"
         "    [[ -z $words && $command == help ]] && words=$commands\n"
         "    [[ -n $words ]] && mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
         "}\n"
         "complete -o default -F _iqfoc iqfoc");
}

/* ---- zsh and fish quote a text by '...' ---- */

static void put_quoted(const char *text, const char *quote, const char *also)
{
    for (; *text != '\0' && *text != '\n'; text++) {
        if (*text == '\'') {
            fputs(quote, stdout);
        } else {
            printf("%s%c", strchr(also, *text) != NULL ? "\\" : "", *text);
        }
    }
}

static void zsh_option(const option_spec *spec)
{
    help_words words;
    help_values(spec, &words);
    printf(" \\\n            '--%s%s[", spec->name, spec->argument != NULL ? "=" : "");
    put_quoted(spec->help, "'\\''", "[]:\\");
    putchar(']');
    if (spec->argument != NULL) {
        putchar(':');
        put_quoted(spec->argument, "'\\''", "[]:\\");
        putchar(':');
        if (words.count > 0) {
            putchar('(');
            put_words(&words, " ");
            putchar(')');
        } else {
            fputs(is_folder(spec) ? "_files -/" : "_files", stdout);
        }
    }
    putchar('\'');
}

void help_zsh(void)
{
    puts("#compdef iqfoc\n# zsh completion of iqfoc; made by `iqfoc help --completion zsh`\n"
         "_iqfoc() {\n"
         "    local -a commands\n"
         "    commands=(");
    for (int n = 0; n < COMMANDS; n++) {
        printf("        '%s:", command_table[n].about->name);
        put_quoted(command_table[n].summary, "'\\''", "\\");
        puts("'");
    }
    puts("    )\n"
         "    if ((CURRENT == 2)); then\n"
         "        _describe -t commands 'command' commands\n"
         "        return\n"
         "    fi\n"
         "    local command=${words[2]}\n"
         "    shift words\n"
         "    ((CURRENT--))\n"
         "    case $command in");
    for (int n = 0; n < COMMANDS; n++) {
        const command_about *about = command_table[n].about;
        printf("    %s)\n        _arguments", about->name);
        for (const option_spec *spec = about->specs; spec->name != NULL; spec++) {
            zsh_option(spec);
        }
        zsh_option(&options_help);
        if (about == &about_help) {
            fputs(" \\\n            '*:command:(", stdout);
            put_commands(" ");
            puts(")' ;;");
        } else {
            puts(" \\\n            '*:file:_files' ;;");
        }
    }
    puts("    esac\n}\n_iqfoc \"$@\"");
}

static void fish_option(const char *under, const option_spec *spec)
{
    help_words words;
    help_values(spec, &words);
    printf("complete -c iqfoc -n '__fish_seen_subcommand_from %s' -l %s", under, spec->name);
    if (spec->letter != 0) {
        printf(" -s %c", spec->letter);
    }
    if (words.count > 0) {
        fputs(" -x -a '", stdout);
        put_words(&words, " ");
        putchar('\'');
    } else if (is_folder(spec)) {
        fputs(" -x -a '(__fish_complete_directories)'", stdout);
    } else if (spec->argument != NULL) {
        fputs(" -r -F", stdout);
    }
    fputs(" -d '", stdout);
    put_quoted(spec->help, "\\'", "\\");
    puts("'");
}

void help_fish(void)
{
    puts("# fish completion of iqfoc; made by `iqfoc help --completion fish`");
    for (int n = 0; n < COMMANDS; n++) {
        printf("complete -c iqfoc -f -n __fish_use_subcommand -a %s -d '", command_table[n].about->name);
        put_quoted(command_table[n].summary, "\\'", "\\");
        puts("'");
    }
    for (int n = 0; n < COMMANDS; n++) {
        const command_about *about = command_table[n].about;
        for (const option_spec *spec = about->specs; spec->name != NULL; spec++) {
            fish_option(about->name, spec);
        }
        fish_option(about->name, &options_help);
    }
    fputs("complete -c iqfoc -f -n '__fish_seen_subcommand_from help' -a '", stdout);
    put_commands(" ");
    puts("'");
}
