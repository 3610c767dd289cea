<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>And also:</source>
        <translation>Und auch:</translation>
    </message>
    <message>
        <source>Bone:</source>
        <translation>Knochen:</translation>
    </message>
    <message>
        <source>CT:</source>
        <translation>CT:</translation>
    </message>
    <message>
        <source>Connection</source>
        <translation>Verbindung</translation>
    </message>
    <message>
        <source>Live</source>
        <translation>Live</translation>
    </message>
    <message>
        <source>More</source>
        <translation>Mehr</translation>
    </message>
    <message>
        <source>None</source>
        <translation>Keines</translation>
    </message>
    <message>
        <source>None (plain average)</source>
        <translation>Keiner (einfacher Mittelwert)</translation>
    </message>
    <message>
        <source>None yet</source>
        <translation>Noch keiner</translation>
    </message>
    <message>
        <source>Open recording, CT, segmentation...</source>
        <translation>Aufnahme, CT, Segmentierung öffnen ...</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pause</translation>
    </message>
    <message>
        <source>Place CT on sweep</source>
        <translation>CT auf den Schwenk legen</translation>
    </message>
    <message>
        <source>Reconstruct</source>
        <translation>Rekonstruieren</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>Aufnehmen</translation>
    </message>
    <message>
        <source>Recorded</source>
        <translation>Aufgenommen</translation>
    </message>
    <message>
        <source>Say where to move next</source>
        <translation>Sagen, wohin als Nächstes</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Einstellungen</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Start</translation>
    </message>
    <message>
        <source>Start over...</source>
        <translation>Neu beginnen ...</translation>
    </message>
    <message>
        <source>Stop</source>
        <translation>Stopp</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Schwenk und CT</translation>
    </message>
    <message>
        <source>Sweep:</source>
        <translation>Schwenk:</translation>
    </message>
    <message>
        <source>Try it on a sample patient</source>
        <translation>An einem Beispielpatienten ausprobieren</translation>
    </message>
    <message>
        <source>Use the scanned box</source>
        <translation>Gescannten Quader nehmen</translation>
    </message>
    <message>
        <source>Vertebrae:</source>
        <translation>Wirbel:</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>nicht gestartet</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>CT agrees: {found}</source>
        <translation>CT stimmt überein: {found}</translation>
    </message>
    <message>
        <source>CT does not agree: {found}</source>
        <translation>CT stimmt nicht überein: {found}</translation>
    </message>
    <message>
        <source>Move the probe more slowly: {fast:.0f} mm/s at most.</source>
        <translation>Sonde langsamer führen: höchstens {fast:.0f} mm/s.</translation>
    </message>
    <message>
        <source>Place the CT on the sweep before you believe the picture.</source>
        <translation>Erst das CT auf den Schwenk legen, dann dem Bild glauben.</translation>
    </message>
    <message>
        <source>Scan {name} again, from other angles.</source>
        <translation>{name} noch einmal scannen, aus anderen Winkeln.</translation>
    </message>
    <message>
        <source>no sweep yet</source>
        <translation>noch kein Schwenk</translation>
    </message>
    <message>
        <source>told after the reconstruction</source>
        <translation>nach der Rekonstruktion bekannt</translation>
    </message>
    <message>
        <source>{frames}, {speed:.0f} mm/s</source>
        <translation>{frames}, {speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{share:.0%} of the echoes, {median:.1f} mm</source>
        <translation>{share:.0%} der Echos, {median:.1f} mm</translation>
    </message>
    <message>
        <source>{used} of {frames} frames</source>
        <translation>{used} von {frames} Bildern</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Select a tracked sweep, or load a recording.</source>
        <translation>Einen Schwenk wählen oder eine Aufnahme laden.</translation>
    </message>
    <message>
        <source>Without bone the sweep is averaged: nothing says at which angle a beam meets it.</source>
        <translation>Ohne Knochen wird der Schwenk gemittelt: Nichts sagt, in welchem Winkel ein Strahl ihn trifft.</translation>
    </message>
</context>
<context>
    <name>panel.lights</name>
    <message>
        <source>Coverage</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>Registration</source>
        <translation>Registrierung</translation>
    </message>
    <message>
        <source>Tracking</source>
        <translation>Verfolgung</translation>
    </message>
    <message>
        <source>being looked at ...</source>
        <translation>wird angesehen ...</translation>
    </message>
</context>
<context>
    <name>panel.livePanel</name>
    <message>
        <source>Bring the probe into the tracker's view</source>
        <translation>Sonde in den Blick des Trackers bringen</translation>
    </message>
    <message>
        <source>Press Start</source>
        <translation>Start drücken</translation>
    </message>
    <message>
        <source>Scan on</source>
        <translation>Weiter scannen</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>nicht gestartet</translation>
    </message>
    <message>
        <source>stopped</source>
        <translation>beendet</translation>
    </message>
</context>
<context>
    <name>panel.recordedPanel</name>
    <message>
        <source>Done.</source>
        <translation>Fertig.</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Schwenk und CT</translation>
    </message>
    <message>
        <source>Sweep and CT: {names}</source>
        <translation>Schwenk und CT: {names}</translation>
    </message>
</context>
<context>
    <name>panel.signals</name>
    <message>
        <source>good</source>
        <translation>gut</translation>
    </message>
    <message>
        <source>look</source>
        <translation>prüfen</translation>
    </message>
    <message>
        <source>not yet</source>
        <translation>noch offen</translation>
    </message>
    <message>
        <source>poor</source>
        <translation>schlecht</translation>
    </message>
</context>
</TS>
