// The only declaration of the error codes. `name_of` and the table of docs/reference/errors.md use it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace octoskin {

/// What kind of fault an error reports. A script and a test compare it; the sentence may change.
enum class ErrorCode : std::uint8_t {
    unknown_key,
    missing_key,
    wrong_type,
    out_of_range,
    unknown_word,
    bad_name,
    bad_value,
    duplicate,
    conflict,
    unknown_name,
    limit_exceeded,
    overload,
    bad_syntax,
    foreign_format,
    unsupported,
    damaged,
    mismatch,
    no_content,
    bad_argument,
    not_found,
    link,
    outside_folder,
    foreign_owner,
    wrong_kind_of_file,
    already_exists,
    no_permission,
    system_error,
    too_large,
    in_use,
    unfinished_move,
    no_device,
    no_program,
    no_listener,
    no_answer,
    no_data,
    no_resources,
    time_limit,
    cancelled,
    self_check,
};

struct ErrorMeaning {
    ErrorCode code;
    std::string_view name;
    std::string_view meaning;
};

/// In the order of the enumeration.
inline constexpr std::array kErrorMeanings = {
    ErrorMeaning{ErrorCode::unknown_key, "unknown_key", "the file has a key that octoskin does not know"},
    ErrorMeaning{ErrorCode::missing_key, "missing_key", "a required key is absent"},
    ErrorMeaning{ErrorCode::wrong_type, "wrong_type",
                 "the value has the wrong type: a text in place of a number, a table in place of a list"},
    ErrorMeaning{ErrorCode::out_of_range, "out_of_range", "the number is outside its range"},
    ErrorMeaning{ErrorCode::unknown_word, "unknown_word", "the word is not one that the key allows"},
    ErrorMeaning{ErrorCode::bad_name, "bad_name", "the name has a character or a length that is not allowed"},
    ErrorMeaning{ErrorCode::bad_value, "bad_value",
                 "the value breaks another rule, for example a quaternion whose length is not 1"},
    ErrorMeaning{ErrorCode::duplicate, "duplicate", "something that must be unique occurs twice"},
    ErrorMeaning{ErrorCode::conflict, "conflict", "two values or options exclude each other"},
    ErrorMeaning{ErrorCode::unknown_name, "unknown_name",
                 "the name refers to a link, joint, node, sensor or model that does not exist"},
    ErrorMeaning{ErrorCode::limit_exceeded, "limit_exceeded",
                 "there is more of something than octoskin accepts"},
    ErrorMeaning{ErrorCode::overload, "overload", "the computed load of a bus exceeds its limit"},
    ErrorMeaning{ErrorCode::bad_syntax, "bad_syntax", "the text does not follow the syntax of its format"},
    ErrorMeaning{ErrorCode::foreign_format, "foreign_format",
                 "the file or answer has another format than expected"},
    ErrorMeaning{ErrorCode::unsupported, "unsupported",
                 "the file is valid, but octoskin does not support a feature or version of it"},
    ErrorMeaning{ErrorCode::damaged, "damaged",
                 "a length or checksum shows that the content is damaged or cut"},
    ErrorMeaning{ErrorCode::mismatch, "mismatch", "the file does not belong to the other inputs"},
    ErrorMeaning{ErrorCode::no_content, "no_content", "the file contains nothing that can be used"},
    ErrorMeaning{ErrorCode::bad_argument, "bad_argument", "the command line or a request is wrong"},
    ErrorMeaning{ErrorCode::not_found, "not_found", "the file or folder does not exist"},
    ErrorMeaning{ErrorCode::link, "link", "a symbolic link is below the named folder"},
    ErrorMeaning{ErrorCode::outside_folder, "outside_folder", "the name leads out of the folder"},
    ErrorMeaning{ErrorCode::foreign_owner, "foreign_owner",
                 "the folder to write to belongs to another user, or others may change a file that only its "
                 "owner may change"},
    ErrorMeaning{ErrorCode::wrong_kind_of_file, "wrong_kind_of_file",
                 "a folder, pipe, device or socket in place of a file, or a file in place of a folder"},
    ErrorMeaning{ErrorCode::already_exists, "already_exists", "the output exists already"},
    ErrorMeaning{ErrorCode::no_permission, "no_permission",
                 "there is no permission to use the file or device"},
    ErrorMeaning{
        ErrorCode::system_error, "system_error",
        "the system reports an error of a read or write; the sentence contains the system's message"},
    ErrorMeaning{ErrorCode::too_large, "too_large", "the file or map exceeds a size limit"},
    ErrorMeaning{ErrorCode::in_use, "in_use", "another program uses the folder, socket or device"},
    ErrorMeaning{ErrorCode::unfinished_move, "unfinished_move",
                 "the folder contains files of a killed run; `octoskin repair` completes the move"},
    ErrorMeaning{ErrorCode::no_device, "no_device", "the device or interface does not exist or fails"},
    ErrorMeaning{ErrorCode::no_program, "no_program", "a program that is needed is not installed"},
    ErrorMeaning{ErrorCode::no_listener, "no_listener", "no daemon listens at the socket"},
    ErrorMeaning{ErrorCode::no_answer, "no_answer", "the daemon or board does not answer"},
    ErrorMeaning{ErrorCode::no_data, "no_data",
                 "data that is needed has not arrived, for example joint states"},
    ErrorMeaning{ErrorCode::no_resources, "no_resources",
                 "there is too little memory, or too few threads or descriptors"},
    ErrorMeaning{ErrorCode::time_limit, "time_limit", "the work took longer than its limit"},
    ErrorMeaning{ErrorCode::cancelled, "cancelled", "the work was cancelled"},
    ErrorMeaning{ErrorCode::self_check, "self_check", "a result contradicts itself: a defect of octoskin"},
};

/// "unknown_key".
[[nodiscard]] constexpr std::string_view name_of(ErrorCode code) noexcept {
    return kErrorMeanings[static_cast<std::size_t>(code)].name;
}

}  // namespace octoskin
