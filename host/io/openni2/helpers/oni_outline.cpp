#include "host/io/openni2/helpers/oni_outline.hpp"

#include "host/io/openni2/helpers/oni_records.hpp"

namespace octoskin::openni2 {

OniOutline outline_of(const std::filesystem::path& oni) {
    OniOutline outline;
    OniRecords records(oni);
    while (const auto record = records.next()) {
        if (record->type == OniRecordType::data_begin) outline.has_begun = true;
        if (record->type == OniRecordType::new_data) ++outline.frames;
        if (record->type == OniRecordType::end) {
            outline.length = record->end;
            break;
        }
    }
    return outline;
}

}  // namespace octoskin::openni2
