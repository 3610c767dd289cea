<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>A network that says where bone is in a frame, as an ONNX file. It is run on this computer's processor, and nothing but this file and the JSON of its name is opened.</source>
        <translation>Ein Netz, das sagt, wo in einem Bild Knochen ist, als ONNX-Datei. Es läuft auf dem Prozessor dieses Rechners, und nur diese Datei und die JSON-Datei ihres Namens werden geöffnet.</translation>
    </message>
    <message>
        <source>And also:</source>
        <translation>Und auch:</translation>
    </message>
    <message>
        <source>Bone from:</source>
        <translation>Knochen aus:</translation>
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
        <source>Name under which the server sends what a network says (device), with the time stamps of its images</source>
        <translation>Name, unter dem der Server sendet, was ein Netz sagt (Gerät), mit den Zeitstempeln seiner Bilder</translation>
    </message>
    <message>
        <source>Network name:</source>
        <translation>Name des Netzes:</translation>
    </message>
    <message>
        <source>Network said:</source>
        <translation>Netz sagte:</translation>
    </message>
    <message>
        <source>Network:</source>
        <translation>Netz:</translation>
    </message>
    <message>
        <source>Networks (*.onnx)</source>
        <translation>Netze (*.onnx)</translation>
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
        <source>What a network has said of the frames (predictions): a sequence of images, one for each frame or with their times, from 0 to 255 or from 0 to 1</source>
        <translation>Was ein Netz zu den Bildern gesagt hat (Vorhersagen): eine Bildsequenz, eines für jedes Bild oder mit dessen Zeiten, von 0 bis 255 oder von 0 bis 1</translation>
    </message>
    <message>
        <source>Who says where bone is: the CT in its place, a neural network that looks at every frame, or the echoes, bright with darkness behind them. Only the CT knows bone that no frame shows.</source>
        <translation>Wer sagt, wo Knochen ist: das CT an seinem Ort, ein neuronales Netz, das jedes Bild ansieht, oder die Echos, hell mit Dunkelheit dahinter. Nur das CT kennt Knochen, den kein Bild zeigt.</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>nicht gestartet</translation>
    </message>
</context>
<context>
    <name>AIFReconGui.packages</name>
    <message>
        <source>A network in a file needs the Python package onnxruntime. Install it now?</source>
        <translation>Ein Netz in einer Datei braucht das Python-Paket onnxruntime. Jetzt installieren?</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>Bone is known from {looked} of {frames} frames.</source>
        <translation>Knochen ist aus {looked} von {frames} Bildern bekannt.</translation>
    </message>
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
        <source>onnxruntime was not installed, and a network in a file needs it: {why}</source>
        <translation>onnxruntime wurde nicht installiert, und ein Netz in einer Datei braucht es: {why}</translation>
    </message>
    <message>
        <source>told after the reconstruction</source>
        <translation>nach der Rekonstruktion bekannt</translation>
    </message>
    <message>
        <source>{count} predictions belong to no frame with a pose.</source>
        <translation>{count} Vorhersagen gehören zu keinem Bild mit einer Lage.</translation>
    </message>
    <message>
        <source>{frames}, {speed:.0f} mm/s</source>
        <translation>{frames}, {speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{packages} is not installed, and a network in a file needs it.</source>
        <translation>{packages} ist nicht installiert, und ein Netz in einer Datei braucht es.</translation>
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
    <name>AIFReconScene.panelWords</name>
    <message>
        <source>The echoes themselves</source>
        <translation>Die Echos selbst</translation>
    </message>
    <message>
        <source>What the network has said belongs to one sweep; got {predictions} for {sweeps}. Leave the others out.</source>
        <translation>Was das Netz gesagt hat, gehört zu einem Schwenk; es sind {predictions} für {sweeps}. Die anderen weglassen.</translation>
    </message>
    <message>
        <source>{name}: predictions of {got} pixels do not fit frames of {frames}. Select what the network has said of this sweep, in its size.</source>
        <translation>{name}: Vorhersagen von {got} Pixeln passen nicht zu Bildern von {frames}. Wählen, was das Netz zu diesem Schwenk gesagt hat, in seiner Größe.</translation>
    </message>
</context>
<context>
    <name>inputs.boneSource</name>
    <message>
        <source>A network in a file</source>
        <translation>Ein Netz in einer Datei</translation>
    </message>
    <message>
        <source>A network that runs elsewhere</source>
        <translation>Ein Netz, das anderswo läuft</translation>
    </message>
    <message>
        <source>A network, as it was recorded</source>
        <translation>Ein Netz, wie es aufgenommen wurde</translation>
    </message>
    <message>
        <source>Bone is looked for in the sweep itself: what is bright with darkness behind it. The docs say how well that works.</source>
        <translation>Knochen wird im Schwenk selbst gesucht: was hell ist, mit Dunkelheit dahinter. Die Dokumentation sagt, wie gut das geht.</translation>
    </message>
    <message>
        <source>Choose the file of the network, or let something else tell where bone is.</source>
        <translation>Die Datei des Netzes wählen, oder etwas anderes sagen lassen, wo Knochen ist.</translation>
    </message>
    <message>
        <source>Enter the name under which the server sends what the network says, or let something else tell where bone is.</source>
        <translation>Den Namen eingeben, unter dem der Server sendet, was das Netz sagt, oder etwas anderes sagen lassen, wo Knochen ist.</translation>
    </message>
    <message>
        <source>Every label above 0 is bone.</source>
        <translation>Jedes Label über 0 ist Knochen.</translation>
    </message>
    <message>
        <source>Images and what the network says of them must have two names; both are {name}.</source>
        <translation>Bilder und das, was das Netz zu ihnen sagt, brauchen zwei Namen; beide heißen {name}.</translation>
    </message>
    <message>
        <source>Select what the network has said of the sweep, or let something else tell where bone is.</source>
        <translation>Wählen, was das Netz zum Schwenk gesagt hat, oder etwas anderes sagen lassen, wo Knochen ist.</translation>
    </message>
    <message>
        <source>Taken for the probability of bone, from 0 to 1.</source>
        <translation>Gilt als Wahrscheinlichkeit von Knochen, von 0 bis 1.</translation>
    </message>
    <message>
        <source>The CT</source>
        <translation>Das CT</translation>
    </message>
    <message>
        <source>The echoes themselves</source>
        <translation>Die Echos selbst</translation>
    </message>
    <message>
        <source>There is no file {path}.</source>
        <translation>Es gibt keine Datei {path}.</translation>
    </message>
    <message>
        <source>What a network says comes from a server: take the images from there too, or let something else tell where bone is.</source>
        <translation>Was ein Netz sagt, kommt von einem Server: Auch die Bilder von dort nehmen, oder etwas anderes sagen lassen, wo Knochen ist.</translation>
    </message>
    <message>
        <source>What the network has said belongs to one sweep: leave the others out, or let something else tell where bone is.</source>
        <translation>Was das Netz gesagt hat, gehört zu einem Schwenk: Die anderen weglassen, oder etwas anderes sagen lassen, wo Knochen ist.</translation>
    </message>
    <message>
        <source>Without bone the sweep is averaged: nothing says at which angle a beam meets it.</source>
        <translation>Ohne Knochen wird der Schwenk gemittelt: Nichts sagt, in welchem Winkel ein Strahl ihn trifft.</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Select a tracked sweep, or load a recording.</source>
        <translation>Einen Schwenk wählen oder eine Aufnahme laden.</translation>
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
        <source>What the network said is in {path}.</source>
        <translation>Was das Netz gesagt hat, ist in {path}.</translation>
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
