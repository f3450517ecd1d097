// toml++ behind the C interface of toml_table.h. A parse error becomes a line of bad news; memory running out on a page of
// text may end the program.
#include "toml_table.h"

#include "../base/suggest.h"
#include "toml_depth.h"

// The parser gives its complaint back; WebAssembly has no exceptions.
#define TOML_EXCEPTIONS 0
// Its assertions hold for no file whatever ("[ =" breaks one ahead of the words for it), and as clang's assumptions they would be
// undefined behaviour: without them the parser says what is wrong.
#undef NDEBUG
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>

#include <cerrno>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <deque>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <vector>

const toml_range TOML_ANY = {-std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::infinity(), false};
const toml_range TOML_POSITIVE = {0.0, std::numeric_limits<double>::infinity(), true};
const toml_range TOML_NOT_NEGATIVE = {0.0, std::numeric_limits<double>::infinity(), false};

struct toml_table {
    toml_file *file;
    const toml::table *node;
    std::string name; // "motor", "extension.dead_time", "run 2"; empty for the root
    std::set<std::string> known;
};

struct toml_file {
    std::string path;
    error *e;
    toml::table root;
    std::deque<toml_table> tables; // a deque: growing it moves no table that a caller points to
};

namespace
{

// A motor or scenario file is a page of text; this much is a recording given in its place.
constexpr size_t largest_file = 4 << 20;

void refuse_at(const toml_file &file, const toml::source_position &at, const std::string &text)
{
    error_input(file.e, file.path.c_str(), static_cast<long>(at.line), static_cast<long>(at.column), "%s",
                text.c_str());
}

std::string number_words(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.15g", value);
    return text;
}

std::string range_words(const toml_range &range)
{
    const bool has_max = std::isfinite(range.max);
    if (std::isfinite(range.min) && has_max) {
        return "a number from " + number_words(range.min) + " to " + number_words(range.max);
    }
    if (std::isfinite(range.min)) {
        return std::string("a number ") + (range.min_open ? "> " : ">= ") + number_words(range.min);
    }
    return has_max ? "a number <= " + number_words(range.max) : "a finite number";
}

std::string whole_words(long min, long max)
{
    return "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
}

// What stands there, short enough for one line: "text \"abc\"", "1.5", "an array".
std::string value_words(const toml::node &node)
{
    if (const auto *text = node.as_string()) {
        const std::string &s = text->get();
        return "text \"" + (s.size() > 40 ? s.substr(0, 40) + "..." : s) + "\"";
    }
    if (const auto *integer = node.as_integer()) {
        return std::to_string(integer->get());
    }
    if (const auto *real = node.as_floating_point()) {
        return number_words(real->get());
    }
    if (const auto *flag = node.as_boolean()) {
        return flag->get() ? "true" : "false";
    }
    return node.is_table() ? "a table" : node.is_array() ? "an array" : "a date or time";
}

std::string in_table(const toml_table &table)
{
    return table.name.empty() ? "" : " in [" + table.name + "]";
}

const toml::node *find(toml_table *table, const char *key)
{
    if (table == nullptr) {
        return nullptr;
    }
    table->known.insert(key);
    return table->node->get(key);
}

void refuse_missing(toml_table *table, const char *key, const std::string &expected)
{
    if (table != nullptr) {
        refuse_at(*table->file, table->node->source().begin,
                  std::string(key) + " is missing" + in_table(*table) + "; expected " + expected);
    }
}

void refuse_value(const toml_table &table, const char *key, const toml::node &node,
                  const std::string &expected)
{
    refuse_at(*table.file, node.source().begin,
              std::string(key) + " must be " + expected + ", not " + value_words(node));
}

// An integer may stand for a real; NaN is what no number is.
double number_of(const toml::node &node)
{
    return node.is_number() ? node.value<double>().value_or(std::nan("")) : std::nan("");
}

bool read_number(const toml_table &table, const char *key, const toml::node &node, const toml_range &range,
                 double *value)
{
    const double read = number_of(node);
    const bool below = range.min_open ? read <= range.min : read < range.min;
    if (!std::isfinite(read) || below || read > range.max) {
        refuse_value(table, key, node, range_words(range));
        return false;
    }
    *value = read;
    return true;
}

toml_table *add_table(toml_file *file, const toml::table *node, const std::string &name)
{
    // Asking twice for one table must not forget which of its keys are known.
    for (toml_table &have : file->tables) {
        if (have.node == node) {
            return &have;
        }
    }
    file->tables.push_back(toml_table{file, node, name, {}});
    return &file->tables.back();
}

std::string inner_name(const toml_table &table, const char *key)
{
    return table.name.empty() ? key : table.name + "." + key;
}

// "; did you mean psi_f_Wb?", or the list of what may stand there.
std::string suggestion(const toml_table &table, const std::string &key)
{
    std::vector<const char *> known;
    std::string all;
    for (const std::string &word : table.known) {
        known.push_back(word.c_str());
        all += (all.empty() ? "" : ", ") + word;
    }
    const char *best = suggest(key.c_str(), known.data(), known.size());
    return best != nullptr ? std::string("; did you mean ") + best + "?" : "; expected one of " + all;
}

// The unknown key that comes first in the file, whatever order the tables were read in.
void refuse_unknown_keys(const toml_file &file)
{
    const toml_table *in = nullptr;
    const toml::key *unknown = nullptr;
    for (const toml_table &table : file.tables) {
        for (const auto &[key, value] : *table.node) {
            (void)value;
            const bool is_known = table.known.count(std::string(key.str())) > 0;
            if (!is_known && (unknown == nullptr || key.source().begin < unknown->source().begin)) {
                in = &table;
                unknown = &key;
            }
        }
    }
    if (unknown != nullptr) {
        const std::string name(unknown->str());
        refuse_at(file, unknown->source().begin,
                  "unknown key " + name + in_table(*in) + suggestion(*in, name));
    }
}

bool read_text(const char *path, std::string &text, error *e)
{
    const std::unique_ptr<FILE, int (*)(FILE *)> stream(std::fopen(path, "rb"), &std::fclose);
    if (stream != nullptr) {
        // One byte more than allowed is asked for: getting it shows that there is too much.
        text.resize(largest_file + 1);
        text.resize(std::fread(text.data(), 1, text.size(), stream.get()));
    }
    if (stream == nullptr || std::ferror(stream.get()) != 0) {
        return error_input(e, path, 0, 0, "cannot be read: %s", std::strerror(errno));
    }
    if (text.size() > largest_file) {
        return error_input(e, path, 0, 0, "is larger than %zu bytes; expected a TOML file", largest_file);
    }
    long line = 0;
    long column = 0;
    return toml_depth_check(text.data(), text.size(), &line, &column) ||
           error_input(e, path, line, column,
                       "the key has more than %d parts; expected a TOML file of this program",
                       static_cast<int>(TOML_KEY_PARTS_MAX));
}

} // namespace

extern "C" toml_file *toml_file_open(const char *path, error *e)
{
    std::string text;
    if (!read_text(path, text, e)) {
        return nullptr;
    }
    toml::parse_result root = toml::parse(text, std::string(path));
    if (!root) {
        const toml::parse_error &problem = root.error();
        const toml::source_position &at = problem.source().begin;
        error_input(e, path, static_cast<long>(at.line), static_cast<long>(at.column), "not TOML: %s",
                    std::string(problem.description()).c_str());
        return nullptr;
    }
    auto *file = new toml_file{path, e, std::move(root).table(), {}};
    add_table(file, &file->root, "");
    return file;
}

extern "C" bool toml_file_close(toml_file *file)
{
    if (file == nullptr) {
        return false;
    }
    refuse_unknown_keys(*file);
    const bool ok = file->e->status == STATUS_DONE;
    delete file;
    return ok;
}

extern "C" toml_table *toml_file_root(toml_file *file)
{
    return file == nullptr ? nullptr : &file->tables.front();
}

extern "C" toml_table *toml_table_inner_or_null(toml_table *table, const char *key)
{
    const toml::node *node = find(table, key);
    if (node == nullptr) {
        return nullptr;
    }
    if (!node->is_table()) {
        refuse_value(*table, key, *node, std::string("a table [") + inner_name(*table, key) + "]");
        return nullptr;
    }
    return add_table(table->file, node->as_table(), inner_name(*table, key));
}

extern "C" toml_table *toml_table_inner(toml_table *table, const char *key)
{
    if (table != nullptr && find(table, key) == nullptr) {
        refuse_missing(table, key, std::string("a table [") + inner_name(*table, key) + "]");
    }
    return toml_table_inner_or_null(table, key);
}

extern "C" size_t toml_table_count(toml_table *table, const char *key)
{
    const toml::node *node = find(table, key);
    if (node == nullptr) {
        return 0;
    }
    const toml::array *array = node->as_array();
    if (array == nullptr || !array->is_homogeneous(toml::node_type::table)) {
        refuse_value(*table, key, *node, std::string("tables [[") + inner_name(*table, key) + "]]");
        return 0;
    }
    return array->size();
}

extern "C" toml_table *toml_table_at(toml_table *table, const char *key, size_t index)
{
    if (index >= toml_table_count(table, key)) {
        return nullptr;
    }
    const toml::node *node = table->node->get(key)->as_array()->get(index);
    return add_table(table->file, node->as_table(),
                     inner_name(*table, key) + " " + std::to_string(index + 1));
}

extern "C" bool toml_has(toml_table *table, const char *key)
{
    return find(table, key) != nullptr;
}

extern "C" bool toml_is_table(toml_table *table, const char *key)
{
    const toml::node *node = find(table, key);
    return node != nullptr && node->is_table();
}

extern "C" double toml_number_or(toml_table *table, const char *key, toml_range range, double absent)
{
    if (const toml::node *node = find(table, key)) {
        read_number(*table, key, *node, range, &absent);
    }
    return absent;
}

extern "C" double toml_number(toml_table *table, const char *key, toml_range range)
{
    if (find(table, key) == nullptr) {
        refuse_missing(table, key, range_words(range));
    }
    return toml_number_or(table, key, range, 0.0);
}

extern "C" long toml_integer_or(toml_table *table, const char *key, long min, long max, long absent)
{
    const toml::node *node = find(table, key);
    if (node == nullptr) {
        return absent;
    }
    const double value = number_of(*node);
    const bool is_whole = std::floor(value) == value; // 3.0 is a whole number too; false for NaN
    if (!is_whole || value < static_cast<double>(min) || value > static_cast<double>(max)) {
        refuse_value(*table, key, *node, whole_words(min, max));
        return absent;
    }
    return static_cast<long>(value);
}

extern "C" long toml_integer(toml_table *table, const char *key, long min, long max)
{
    if (find(table, key) == nullptr) {
        refuse_missing(table, key, whole_words(min, max));
    }
    return toml_integer_or(table, key, min, max, min);
}

extern "C" size_t toml_numbers(toml_table *table, const char *key, toml_range range, double *values,
                               size_t max)
{
    const toml::node *node = find(table, key);
    if (node == nullptr) {
        return 0;
    }
    const toml::array *array = node->as_array();
    if (array == nullptr) {
        return max > 0 && read_number(*table, key, *node, range, values) ? 1 : 0;
    }
    if (array->empty() || array->size() > max) {
        refuse_at(*table->file, node->source().begin,
                  std::string(key) + " must hold 1 to " + std::to_string(max) + " numbers, not " +
                      std::to_string(array->size()));
        return 0;
    }
    for (size_t i = 0; i < array->size(); i++) {
        if (!read_number(*table, key, *array->get(i), range, &values[i])) {
            return 0;
        }
    }
    return array->size();
}

extern "C" bool toml_flag_or(toml_table *table, const char *key, bool absent)
{
    const toml::node *node = find(table, key);
    if (node == nullptr) {
        return absent;
    }
    const auto *flag = node->as_boolean();
    if (flag == nullptr) {
        refuse_value(*table, key, *node, "true or false");
        return absent;
    }
    return flag->get();
}

extern "C" void toml_text_or_keep(toml_table *table, const char *key, char *text, size_t size)
{
    const toml::node *node = find(table, key);
    if (node == nullptr) {
        return;
    }
    const auto *string = node->as_string();
    if (string == nullptr || string->get().empty() || string->get().size() >= size ||
        string->get().find('\0') != std::string::npos) {
        refuse_value(*table, key, *node, "text of 1 to " + std::to_string(size - 1) + " bytes");
        return;
    }
    std::memcpy(text, string->get().c_str(), string->get().size() + 1);
}

extern "C" size_t toml_choice_or(toml_table *table, const char *key, const char *const *words, size_t count,
                                 size_t absent)
{
    const toml::node *node = find(table, key);
    if (node == nullptr) {
        return absent;
    }
    std::string all;
    for (size_t i = 0; i < count; i++) {
        const auto *string = node->as_string();
        if (string != nullptr && string->get() == words[i]) {
            return i;
        }
        all += std::string(i == 0 ? "\"" : i + 1 == count ? " or \"" : ", \"") + words[i] + "\"";
    }
    refuse_value(*table, key, *node, all);
    return absent;
}

extern "C" bool toml_position(toml_table *table, const char *key, long *line, long *column)
{
    const toml::node *node = find(table, key);
    if (node != nullptr) {
        *line = static_cast<long>(node->source().begin.line);
        *column = static_cast<long>(node->source().begin.column);
    }
    return node != nullptr;
}

extern "C" bool toml_refuse(toml_table *table, const char *key, const char *format, ...)
{
    if (table == nullptr) {
        return false;
    }
    const toml::node *node = find(table, key);
    const toml::source_position &at = (node != nullptr ? node->source() : table->node->source()).begin;
    va_list args;
    va_start(args, format);
    error_input_args(table->file->e, table->file->path.c_str(), static_cast<long>(at.line),
                     static_cast<long>(at.column), format, args);
    va_end(args);
    return false;
}
