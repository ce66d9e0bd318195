#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace brink {

/// The words of each line that names a field, by its name.
using TextFields = std::map<std::string, std::vector<std::string>>;

/// "name: word word ..." on each line; lines without the separator are left out.
/// @param separator between a name and its words. @param blanks letters that part words, as blanks do.
TextFields read_text_fields(const std::string& text, char separator, std::string_view blanks = "");

/// The numbers of a field. @throws std::runtime_error "path: ..." when it is missing, has another count, or other words.
std::vector<double> read_text_field(const std::string& path, const TextFields& fields, const std::string& name,
                                    std::size_t count);

}  // namespace brink
