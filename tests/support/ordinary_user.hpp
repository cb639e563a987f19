// Tests of permissions, which do not bind root.
#pragma once

#include <unistd.h>

namespace ecs {

/// An ordinary user for some lines of a test, where root runs it.
class OrdinaryUser {
 public:
  OrdinaryUser() { (void)!::seteuid(65534); }
  OrdinaryUser(const OrdinaryUser&) = delete;
  OrdinaryUser& operator=(const OrdinaryUser&) = delete;
  ~OrdinaryUser() { (void)!::seteuid(0); }
};

}  // namespace ecs
