#!/bin/busybox sh
# The first process of the virtual machine: loads the modules, mounts the host's own files, and then runs what is asked for
# on the second serial line, one script at a time: `NAME SECONDS`, or `off`.
b=/bin/busybox
$b mount -t proc proc /proc
$b mount -t devtmpfs devtmpfs /dev
while read -r module; do
    $b insmod "/modules/$module" || echo "init: $module does not load"
done </modules.load
read -r folder </folder

# Nothing of the host changes while the machine reads it, so it may remember: loose. Its own folder is another matter.
$b mount -t 9p host_files /root -o trans=virtio,version=9p2000.L,msize=1048576,ro,cache=loose || exec $b poweroff -f
$b mount -t proc proc /root/proc
$b mount -t sysfs sysfs /root/sys
$b mount -t configfs configfs /root/sys/kernel/config
$b mount -t devtmpfs devtmpfs /root/dev
$b mount -t tmpfs tmpfs /root/run
$b ln -s /proc/self/fd /root/dev/fd
$b mount -t 9p host_folder "/root$folder" -o trans=virtio,version=9p2000.L,msize=1048576,cache=none || exec $b poweroff -f

export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/run TMPDIR=/run LC_ALL=C.UTF-8
out=/root$folder
control=/dev/ttyS1
exec 3<$control
$b stty -F $control raw -echo
: >"$out/up"
while read -r name seconds <&3; do
    [ "$name" != off ] || break
    $b timeout -k 2 -s TERM "$seconds" $b chroot /root /bin/bash "$folder/$name.sh" >"$out/$name.out" 2>&1 </dev/null
    code=$?
    [ $code -ne 143 ] || code=124  # busybox's timeout says how it ended the command, coreutils' that it did
    echo $code >"$out/$name.code.new"
    $b mv "$out/$name.code.new" "$out/$name.code"
done
exec $b poweroff -f
