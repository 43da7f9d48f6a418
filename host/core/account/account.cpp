#include "host/core/account/account.hpp"

#include <iomanip>
#include <sstream>

namespace octoskin {

std::string to_text(const AccountTable& table) {
    std::uint64_t rejected = 0;
    for (const AccountTable::Row& row : table.rejected) {
        rejected += row.count;
    }
    std::ostringstream text;
    text << std::left << std::setw(22) << table.unit << std::right << std::setw(10) << table.in
         << " in = " << table.used << " used + " << rejected << " rejected";
    if (table.pending > 0) {
        text << " + " << table.pending << " pending";
    }
    text << (table.is_balanced ? "\n" : "   NOT BALANCED\n");
    for (const AccountTable::Row& row : table.rejected) {
        if (row.count > 0) {
            text << "  " << std::left << std::setw(28) << row.name << std::right << std::setw(10) << row.count
                 << "\n";
        }
    }
    return text.str();
}

}  // namespace octoskin
