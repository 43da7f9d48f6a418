#!/bin/sh
# camera_drivers_test.sh CAMERA-PROGRAM: it loads the drivers of real cameras, which need none to be plugged in, and not the
# virtual camera's.
set -eu
loaded=$(LD_DEBUG=files "$1" '' 2>&1 > /dev/null | grep "calling init" || true)
for driver in libOniFile libPS1080 libPSLink; do
    echo "$loaded" | grep -q "OpenNI2/Drivers/$driver" || { echo "$driver is not loaded"; exit 1; }
done
! echo "$loaded" | grep libOctoskinVirtual
