// nlohmann's JSON for Modern C++ behind the C interface of json.h: json_t has no members of its own, it is the name that C
// knows a tree by. Nothing here throws but for want of memory.
#include "json.h"

#include "inputs.h"
#include "number.h"

#include <nlohmann/json.hpp>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

using tree = nlohmann::ordered_json;

static json_t *c_of(tree *value)
{
    return reinterpret_cast<json_t *>(value);
}

static tree *of(json_t *value)
{
    return reinterpret_cast<tree *>(value);
}

static const tree *of(const json_t *value)
{
    return reinterpret_cast<const tree *>(value);
}

static json_t *made(tree value)
{
    return c_of(new tree(std::move(value)));
}

// ---- Made ----

json_t *json_object(void)
{
    return made(tree::object());
}

json_t *json_array(void)
{
    return made(tree::array());
}

json_t *json_boolean(bool value)
{
    return made(value);
}

json_t *json_null(void)
{
    return made(nullptr);
}

json_t *json_integer(json_int_t value)
{
    return made(value);
}

json_t *json_real(double value)
{
    return std::isfinite(value) ? made(value) : nullptr;
}

json_t *json_number(double x)
{
    return std::isfinite(x) ? made(x) : json_null();
}

json_t *json_string(const char *text)
{
    return text != nullptr ? made(text) : nullptr;
}

int json_array_append_new(json_t *array, json_t *value)
{
    const bool ok = json_is_array(array) && value != nullptr;
    if (ok) {
        of(array)->push_back(std::move(*of(value)));
    }
    json_free(value);
    return ok ? 0 : -1;
}

json_t *json_appended(json_t *array, json_t *value)
{
    if (json_array_append_new(array, value) != 0) {
        json_free(array);
        return nullptr;
    }
    return array;
}

int json_object_set_new(json_t *object, const char *key, json_t *value)
{
    const bool ok = json_is_object(object) && value != nullptr;
    if (ok) {
        (*of(object))[key] = std::move(*of(value));
    }
    json_free(value);
    return ok ? 0 : -1;
}

int json_object_update(json_t *object, const json_t *more)
{
    if (!json_is_object(object) || !json_is_object(more)) {
        return -1;
    }
    of(object)->update(*of(more));
    return 0;
}

void json_free(json_t *value)
{
    delete of(value);
}

// ---- Looked into ----

json_t *json_object_get(const json_t *object, const char *key)
{
    if (!json_is_object(object)) {
        return nullptr;
    }
    const auto found = of(object)->find(key);
    return found != of(object)->end() ? c_of(const_cast<tree *>(&*found)) : nullptr;
}

json_t *json_array_get(const json_t *array, size_t index)
{
    return index < json_array_size(array) ? c_of(const_cast<tree *>(&(*of(array))[index])) : nullptr;
}

size_t json_array_size(const json_t *array)
{
    return json_is_array(array) ? of(array)->size() : 0;
}

bool json_is_object(const json_t *value)
{
    return value != nullptr && of(value)->is_object();
}

bool json_is_array(const json_t *value)
{
    return value != nullptr && of(value)->is_array();
}

bool json_is_string(const json_t *value)
{
    return value != nullptr && of(value)->is_string();
}

bool json_is_number(const json_t *value)
{
    return value != nullptr && of(value)->is_number();
}

bool json_is_true(const json_t *value)
{
    return value != nullptr && of(value)->is_boolean() && of(value)->get<bool>();
}

bool json_is_null(const json_t *value)
{
    return value != nullptr && of(value)->is_null();
}

double json_number_value(const json_t *value)
{
    return json_is_number(value) ? of(value)->get<double>() : 0.0;
}

const char *json_string_value(const json_t *value)
{
    return json_is_string(value) ? of(value)->get_ptr<const std::string *>()->c_str() : nullptr;
}

bool json_equal(const json_t *a, const json_t *b)
{
    return a != nullptr && b != nullptr && *of(a) == *of(b);
}

// ---- Printed ----

static const int INDENT = 2;

static void put_indent(FILE *out, int depth)
{
    std::fprintf(out, "\n%*s", depth * INDENT, "");
}

static void put_real(FILE *out, double value)
{
    char text[NUMBER_TEXT_SIZE];
    number_text(value, text);
    std::fputs(text, out);
    // A real stays one for readers that tell 5 from 5.0.
    if (std::strpbrk(text, ".e") == nullptr) {
        std::fputs(".0", out);
    }
}

// nlohmann's knows how to escape text, and prints what is neither real, array nor object.
static void put_plain(FILE *out, const tree &value)
{
    const std::string text = value.dump(-1, ' ', false, tree::error_handler_t::replace);
    std::fwrite(text.data(), 1, text.size(), out);
}

static void put_value(FILE *out, const tree &value, int depth);

// On one line if short enough in kind: [4.11, 4.25].
static void put_array(FILE *out, const tree &array, int depth)
{
    bool flat = true;
    for (const tree &value : array) {
        flat = flat && !value.is_structured();
    }
    const char *between = "";
    std::fputc('[', out);
    for (const tree &value : array) {
        std::fputs(between, out);
        between = flat ? ", " : ",";
        if (!flat) {
            put_indent(out, depth + 1);
        }
        put_value(out, value, depth + 1);
    }
    if (!flat) {
        put_indent(out, depth);
    }
    std::fputc(']', out);
}

static void put_object(FILE *out, const tree &object, int depth)
{
    const char *between = "";
    std::fputc('{', out);
    for (const auto &member : object.items()) {
        std::fputs(between, out);
        between = ",";
        put_indent(out, depth + 1);
        put_plain(out, member.key());
        std::fputs(": ", out);
        put_value(out, member.value(), depth + 1);
    }
    if (!object.empty()) {
        put_indent(out, depth);
    }
    std::fputc('}', out);
}

static void put_value(FILE *out, const tree &value, int depth)
{
    if (value.is_object()) {
        put_object(out, value, depth);
    } else if (value.is_array()) {
        put_array(out, value, depth);
    } else if (value.is_number_float()) {
        put_real(out, value.get<double>());
    } else {
        put_plain(out, value);
    }
}

void json_print(FILE *out, const json_t *value)
{
    put_value(out, *of(value), 0);
}

// ---- Read ----

static const size_t LARGEST_FILE = size_t{64} << 20;

// nlohmann's maker of a tree, but for its way with a mistake.
class reader : public nlohmann::detail::json_sax_dom_parser<tree>
{
  public:
    reader(tree &made, const std::string &text, json_complaint &complaint)
        : json_sax_dom_parser(made, false), text_(text), wrong_(complaint)
    {
    }
    bool parse_error(std::size_t position, const std::string & /*token*/,
                     const nlohmann::detail::exception &complaint)
    {
        const size_t end = position < text_.size() ? position : text_.size();
        wrong_.line = 1;
        for (size_t k = 0; k + 1 < end; k++) {
            wrong_.line += text_[k] == '\n' ? 1 : 0;
        }
        // Its own number and the place stand ahead of the words.
        const char *words = complaint.what();
        const char *colon = std::strstr(words, ": ");
        std::snprintf(wrong_.text, sizeof wrong_.text, "%s", colon != nullptr ? colon + 2 : words);
        return false;
    }

  private:
    const std::string &text_;
    json_complaint &wrong_;
};

static bool read_text(const char *path, std::string &text, json_complaint &wrong)
{
    FILE *in = std::fopen(path, "rb");
    if (in == nullptr) {
        std::snprintf(wrong.text, sizeof wrong.text, "cannot be read: %s", std::strerror(errno));
        return false;
    }
    if (!inputs_note(fileno(in), path, &wrong.file)) {
        std::fclose(in);
        return false;
    }
    char block[4096];
    size_t got = std::fread(block, 1, sizeof block, in);
    while (got > 0 && text.size() <= LARGEST_FILE) {
        text.append(block, got);
        got = std::fread(block, 1, sizeof block, in);
    }
    const bool failed = std::ferror(in) != 0;
    const int why = errno;
    std::fclose(in);
    if (failed) {
        std::snprintf(wrong.text, sizeof wrong.text, "cannot be read: %s", std::strerror(why));
    } else if (text.size() > LARGEST_FILE) {
        std::snprintf(wrong.text, sizeof wrong.text, "the file is larger than 64 MiB");
    }
    return wrong.text[0] == '\0';
}

json_t *json_read(const char *path, json_complaint *wrong)
{
    std::string text;
    tree value;
    *wrong = json_complaint{};
    if (!read_text(path, text, *wrong)) {
        return nullptr;
    }
    reader makes(value, text, *wrong);
    return tree::sax_parse(text, &makes) ? made(std::move(value)) : nullptr;
}
