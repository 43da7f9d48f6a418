// Matrices of doubles as bytes, column by column.
#pragma once

#include <Eigen/Core>

#include "host/io/snapshot/bytes.hpp"

namespace octoskin::snapshot {

/// Throws std::bad_alloc.
template <class Matrix>
void put_matrix(ByteWriter& writer, const Matrix& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) writer.put(*(matrix.data() + i));
}

template <class Matrix>
void get_matrix(ByteReader& reader, Matrix& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) *(matrix.data() + i) = reader.get<double>();
}

}  // namespace octoskin::snapshot
