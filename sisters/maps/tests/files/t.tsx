<?xml version="1.0" encoding="UTF-8"?>
<tileset name="t" tilewidth="16" tileheight="16" tilecount="4" columns="2">
 <image source="t.png" width="32" height="32"/>
 <tile id="1"><properties><property name="opaque" type="bool" value="true"/></properties></tile>
</tileset>
