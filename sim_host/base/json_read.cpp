// A JSON file as a value, by nlohmann's parser (json.h). Nothing here throws but for want of memory.
#include "json.h"

#include <nlohmann/json.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

using tree = nlohmann::ordered_json;

static const size_t LARGEST_FILE = size_t{64} << 20;

// Takes nothing but the parser's complaint.
class listener : public nlohmann::json_sax<tree>
{
  public:
    listener(const std::string &text, json_complaint &complaint) : text_(text), wrong_(complaint)
    {
    }
    bool null() override
    {
        return true;
    }
    bool boolean(bool /*value*/) override
    {
        return true;
    }
    bool number_integer(number_integer_t /*value*/) override
    {
        return true;
    }
    bool number_unsigned(number_unsigned_t /*value*/) override
    {
        return true;
    }
    bool number_float(number_float_t /*value*/, const string_t & /*text*/) override
    {
        return true;
    }
    bool string(string_t & /*value*/) override
    {
        return true;
    }
    bool binary(binary_t & /*value*/) override
    {
        return true;
    }
    bool start_object(std::size_t /*count*/) override
    {
        return true;
    }
    bool key(string_t & /*value*/) override
    {
        return true;
    }
    bool end_object() override
    {
        return true;
    }
    bool start_array(std::size_t /*count*/) override
    {
        return true;
    }
    bool end_array() override
    {
        return true;
    }
    bool parse_error(std::size_t position, const std::string & /*token*/,
                     const nlohmann::detail::exception &complaint) override
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
    *wrong = json_complaint{};
    if (!read_text(path, text, *wrong)) {
        return nullptr;
    }
    listener sees(text, *wrong);
    if (!tree::sax_parse(text, &sees)) {
        return nullptr;
    }
    return reinterpret_cast<json_t *>(new tree(tree::parse(text, nullptr, false)));
}
