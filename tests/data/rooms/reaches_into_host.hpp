#pragma once
#include "host/core/mapping/fused_map.hpp"
