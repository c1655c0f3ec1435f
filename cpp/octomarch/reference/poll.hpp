// How long scalar work stays interruptible. Callers hand in a Poll; the evaluator calls it now and then.
#pragma once

#include <functional>

namespace octomarch::reference {

/// Called every few milliseconds of work, on the working thread. It stops the work by throwing; may be empty.
using Poll = std::function<void()>;

}  // namespace octomarch::reference
