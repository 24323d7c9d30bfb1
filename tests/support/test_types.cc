#include "test_types.h"

#include "common/bus/type_support_of.h"

namespace conav::bus {

template const TypeSupport& TypeSupportOf<conav_test::msg::Blob>();
template const TypeSupport& TypeSupportOf<conav_test::msg::KeyedBlob>();

}  // namespace conav::bus
