"""Transform files of programs that no test can start: made with h5py 3.16, so by the HDF5 library, and compressed here."""

from __future__ import annotations

import base64
import zlib

_OLDER = (
    "eNrtWk9PE0EUn90F2SDGJfFQQLQmHtQItnZRTrKEfzUSaKQh3NoatqGJ7TYtJPXmUb+B+gk88g3cI0eOHEm86I1vgJ3ue/tnkC2ilm77foe+vn2vM9u3b+Y3"
    "83Y+pheXbwyPDzMOVWUDTGN+nAKOZ4M62vMgJZAfQH6V8brUssXg+ii0L/plXy8tce9TAdhPYsCRBiP0I9JL8xku90HPgDyaCM8z+5GjHz8O9ztMOvpJKtiv"
    "xAad3JZQd34pSVIg71EqTTv/Ptb84C1rrk1tfQ42Jddl2bmsQnuKBA7C+PNGSndgY219kccE49cYDPeHP8XiSrjfA/y318L9Eihj4X44T3waCj4fYwzmrYmr"
    "jWPn8kqLRSGvOhePeETi8ft5Sszfc/n1NvDrnfB+OK1qqhfblYX1VckXHsnnx6FPJ1szpOw+BwfJ6dmAjtPCaqmy1/D9HtubEfwmQS5Y5apVL+2a2VqhUi9a"
    "tXJu29p789bMpXK8Y5wexkHOF4ulynnOTQz9ob+Lm8S5BAKBQCAQCAQCgUDoXSi+eoAM+3PUFdbJOk0i7rTQ3XWatu8toLAZo9TqS+B7iy3QIanZe6H+jHVt"
    "eA3BngrjaPaS/b/Mvto0a/WSVYH7WVwO6Osba4WyyWXgMnMrZCs1a6/q3Uf+isZR4yHzzRqEfh9HOJ8eCPVtN2+z76qmb/wYl+y3c3xnRILvJN96gNf0J306"
    "XyuM+3Req//ymePnXKqF79+wHdDn0B7e6wnY78Nj1EG+sIN2fMyq4b+PoTPttOunnV2Dfm6BjBk0QgkEAoHQy3DO/yjuOtwWzteI5w5wNXMgB/3Ec1m4njsR"
    "/M47l9UbcZS881F3Kbf+x75xZ5r2jbRv9PaNaTRMhe8buc7VTKFWKJu7Zq3u+fHry6WGue0z4nyldXzfmInEvhF5A+tcdiLcH/lg/0m4H47rran+yOd2eTUC"
    "fiNCXo3G5yBWBtOvM/1UYUJeyUJe5SGv8l1ejwiPh+LG4W/jYceDmdmd8WhbR50hPiQ+PMuHmt4rfHgUST48fH4xPrSfXYwPd3Tiw3/Lhz+IDwPxSN+LAh/+"
    "AvoQOWU="
)
_COMPRESSED = (
    "eNrr9HBx4+WS4mLi4GCAgf9QcMIIwjeAiv+cPme/v4dLEBNDBZMQskIY4GJiYGRgYBNlAFJcniHeYalFxZn5eZuh+qESQBuhEvsZIRICAgwMbawQthUDQuwx"
    "C4StAHea7Ia2a2AnMDIwMoowMDAxAgFUDkYzizAwSgI5AgwQDBHnYGAFuo6ZiQPocmZGBqhvBWAGb2AYcqCIeYEtNcJCQGLoh8XdFZeWUyMsFIZBWPCt9Wik"
    "RlgYDIOwuH7g1lt/Zw9vNhGQHzn9g6Elz3VmiLyJddcXYoo0HpB2RoMD0EKKwYN6TmQ94sIKdqIgyA42/2C/xNzU00zQIlMSJMgXUpSYV5yWX5TrXpRfWsAM"
    "dUVQ99oPxDheAmQGL9yMkMqCVGc2qPlyIDlhuFxAYhHQ9hJgIAVIIMphf3YIWx/mZjYYw7SD2ZEaac1hGKQ1+Q69JeCIVAb5UQIepm6ZFakpiIDt0YQof1/h"
    "t2jgHQ2qYQU4EBHm7uzvw4gUE4xI6sAZRs/QGEQzwSIXShvqWaDwYRnFJzOvtAJJP8w8UzR1UlDaMS0tMy8VHnbxKfmlSTmp8cbxxqjuTuBnGAWjYBSMglEw"
    "CkbBKBgFo2AUjIJRMApGAZmAGWk8gAnaP4fxmaH9dxifBdpvh/FBatEHg3ig5sJo0GCQoII9dPzdgcGEm8HkP9Bg8GAQNzcPAyNQF2isDWwahzBQBxNTjCTC"
    "ELDG+YM+HJcfL5YOCXJ1BfkEfVhOE4eeHkVUPizMOEaT5SgYBaNgFIyCUTBsQUXcbFNhlrhb0s0HH//lCWB4evt80ynjB6zyCz5p8QncYvG6LcvA0F0suKYi"
    "LjmBoZH/G4/AA4aFFjIM4tsZd4wG3ygYBaNgFIyCUTAkAfrYCWwtBZwmZ+xkhhbCkCEydmJfF70R19iJCA49W9HGTmBhNjp2MgpGwSgYBaNgFAxfAAABefg/"
)

OLDER_HDF5 = zlib.decompress(base64.b64decode(_OLDER))
"""As ITK 4 and Slicer 4: superblock 0, groups as symbol tables, names misspelt; a composite of two affine transforms."""

COMPRESSED_HDF5 = zlib.decompress(base64.b64decode(_COMPRESSED))
"""As ITK 5 where it is asked to compress, as ANTs does: one affine transform, each list of its numbers in a compressed chunk."""
