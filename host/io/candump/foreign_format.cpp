#include "host/io/candump/foreign_format.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace octoskin::candump {
namespace {

bool begins_with_any(std::string_view text, std::initializer_list<std::string_view> prefixes) {
    return std::ranges::any_of(prefixes, [&](std::string_view prefix) { return text.starts_with(prefix); });
}

bool has(std::string_view text, std::string_view part) {
    return text.find(part) != std::string_view::npos;
}

bool is_blf(std::string_view begin) {
    return begin.starts_with("LOGG");
}
bool is_mdf(std::string_view begin) {
    return begin.starts_with("MDF ");
}
bool is_sqlite(std::string_view begin) {
    return begin.starts_with("SQLite format 3");
}
bool is_gzip(std::string_view begin) {
    return begin.starts_with("\x1F\x8B");
}
bool is_asc(std::string_view begin) {
    return begins_with_any(begin, {"date ", "base hex", "base dec"}) ||
           has(begin, "\nbase hex  timestamps") || has(begin, "\nBegin Triggerblock");
}
bool is_trc(std::string_view begin) {
    return begins_with_any(begin, {";$FILEVERSION", ";##", ";---"});
}
bool is_python_csv(std::string_view begin) {
    return begin.starts_with("timestamp,arbitration_id,");
}
bool is_gvret_csv(std::string_view begin) {
    return begin.starts_with("Time Stamp,ID,Extended");
}
bool is_busmaster(std::string_view begin) {
    return begin.starts_with("***BUSMASTER");
}

/// "1320745424.000 R11 7E8 ..." or "... CXX text": a time and the kind of record, which may follow the number
/// of a bus.
bool is_crtd(std::string_view begin) {
    const std::size_t blank = begin.find(' ');
    if (blank == std::string_view::npos || blank == 0) return false;
    const auto is_of_time = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
    std::string_view kind = begin.substr(blank + 1, 5);
    if (!kind.empty() && std::isdigit(static_cast<unsigned char>(kind.front())) != 0) kind.remove_prefix(1);
    return std::ranges::all_of(begin.substr(0, blank), is_of_time) &&
           begins_with_any(kind, {"R11 ", "R29 ", "T11 ", "T29 ", "CXX ", "CVR ", "CEV "});
}

constexpr std::string_view kLogConvert = "can_logconvert IN OUT";
constexpr std::string_view kAwk = "awk";

/// The part of an awk program that prints a frame: at `t` seconds, identifier `i` (extended: `x`) with its
/// full number of digits, and as data the fields from `b` to `e`.
constexpr std::string_view kPrintFrame =
    "n=length(i);i=x?substr(\"00000000\" i,n+1):substr(\"000\" i,n+1);d=\"\";for(k=b;k<=e;k++)d=d $k;"
    "printf(\"(%.6f) can0 %s#%s\\n\",t,i,d)}' IN > OUT";

constexpr std::array<ForeignFormat, 10> kFormats{{
    {"Vector ASC", is_asc, "asc2log -I IN -O OUT", ""},
    {"Vector BLF", is_blf, kLogConvert, ""},
    {"PEAK TRC", is_trc, kLogConvert, ""},
    {"ASAM MDF", is_mdf, kLogConvert, ""},
    {"python-can CSV", is_python_csv, kLogConvert, ""},
    {"python-can SQLite", is_sqlite, kLogConvert, ""},
    {"gzip", is_gzip, "zcat IN > OUT", ""},
    {"BUSMASTER", is_busmaster, kAwk,
     "{sub(/\\r/,\"\")}$2~/^[RT]x$/{split($1,h,\":\");t=h[1]*3600+h[2]*60+h[3]+h[4]/(length(h[4])>3?1e4:1e3);"
     "i=$4;sub(/^0x/,\"\",i);x=$5~/^x/;if(!x)sub(/^00000/,\"\",i);b=7;e=NF;"},
    {"CRTD", is_crtd, kAwk,
     "{sub(/\\r/,\"\")}$2~/^[0-9]?[RT](11|29)$/{t=$1;i=$3;x=$2~/29$/;if(!x)sub(/^00000/,\"\",i);b=4;e=NF;"},
    {"GVRET CSV", is_gvret_csv, "awk -F,",
     "NR==1{o=$4==\"Dir\"}NR>1{t=$1/1e6;i=$2;x=$3~/^(true|1)$/;if(!x)sub(/^00000/"
     ",\"\",i);b=6+o;e=b+$(5+o)-1;"},
}};

}  // namespace

std::span<const ForeignFormat> foreign_formats() noexcept {
    return kFormats;
}

const ForeignFormat* foreign_format_of(std::string_view begin) {
    const auto found = std::ranges::find_if(
        kFormats, [&](const ForeignFormat& format) { return format.is_begun_by(begin); });
    return found == kFormats.end() ? nullptr : &*found;
}

std::string conversion(const ForeignFormat& format, std::string_view in, std::string_view out) {
    std::string command(format.command);
    if (!format.awk.empty()) command.append(" '").append(format.awk).append(kPrintFrame);
    // Both places are found before a name is inserted, because a name may contain either word. OUT is the
    // last.
    constexpr std::string_view kIn = "IN";
    constexpr std::string_view kOut = "OUT";
    const std::size_t in_at = command.rfind(kIn);
    command.replace(command.rfind(kOut), kOut.size(), out);
    command.replace(in_at, kIn.size(), in);
    return command;
}

}  // namespace octoskin::candump
