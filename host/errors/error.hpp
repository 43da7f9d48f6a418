// An error as data. A program compares the fields; a person reads the sentence that message() makes of them.
#pragma once

#include <filesystem>
#include <string>

#include "host/errors/error_code.hpp"

namespace octoskin {

struct Error {
    ErrorCode code = ErrorCode::bad_value;
    std::string what = {};            ///< the rule that is broken: "expected a number from 0 to 1"
    std::string value = {};           ///< the value that was found, as the message shows it: "'2,5'"
    std::string remedy = {};          ///< what the user can do
    std::filesystem::path file = {};  ///< the file, folder, socket or device at fault
    int line = 0;                     ///< from 1; 0 if the error concerns the whole file
    int column = 0;                   ///< from 1; 0 if unknown
    std::string key = {};             ///< "nodes[0].sensors[3].name", or the element: "link 'tool'"
    std::string others = {};          ///< one more sentence, such as further places: "2 more refused: ..."

    /// "FILE:LINE:COLUMN: KEY: WHAT, found VALUE: REMEDY. OTHERS", without the parts that are empty. It
    /// contains every field but the code.
    [[nodiscard]] std::string message() const;
    /// The message without file, line, column and key.
    [[nodiscard]] std::string reason() const;
};

/// The same error with this file and line.
[[nodiscard]] Error in_file(Error error, const std::filesystem::path& file, int line = 0);

}  // namespace octoskin
